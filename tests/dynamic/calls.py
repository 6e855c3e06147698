"""A service and an action of types that no package has, described by their node: the test compares the output."""

from __future__ import annotations

import threading

import ifgen.dynamic
import rclpy
from ifgen.dynamic import DescribeError, describe_action, describe_service
from rclpy.action import ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState

ADD = "float64 a\nfloat64 b 0.1\n---\nfloat64 sum\n"
COUNT = "int8 count\n---\nfloat64 sum\n---\nfloat64 last\n"


def main() -> None:
    rclpy.init()
    node, asking = rclpy.create_node("server"), rclpy.create_node("asking")
    add = ifgen.dynamic.class_from_text("nobody_msgs/srv/Add", ADD)
    count = ifgen.dynamic.class_from_text("nobody_msgs/action/Count", COUNT)
    server = ActionServer(node, count, "/count", lambda _: count.Result())
    service = node.create_service(add, "add", lambda _, response: response)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    try:
        show(lambda: describe_action(asking, "/count", timeout=20.0), count)
        show(lambda: describe_service(asking, "add", timeout=20.0), add)
        service.configure_introspection(
            node.get_clock(), qos_profile_services_default, ServiceIntrospectionState.METADATA
        )
        while not asking.get_publishers_info_by_topic("/add/_service_event"):
            rclpy.spin_once(asking, timeout_sec=0.1)
        show(lambda: describe_service(asking, "add", timeout=20.0), add)
        show(lambda: describe_service(asking, "/missing", timeout=0.1), add)
        show(lambda: describe_action(asking, "/missing", timeout=0.1), count)
    finally:
        server.destroy()
        executor.shutdown()
        rclpy.shutdown()
        spinning.join(10.0)
    print("end")


def show(describe, real) -> None:  # type: ignore[no-untyped-def]
    try:
        found = describe()
    except DescribeError as error:
        print(error)
        return
    made = ifgen.dynamic.class_of(found)
    same = made.__type_hash__ == found.type_hash == real.__type_hash__
    print(found.type_name, found.node, same, made.Request(a=0.2) if hasattr(made, "Request") else made.Goal())


if __name__ == "__main__":
    main()
