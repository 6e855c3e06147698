"""A conversation about types that no package has, on any transport: what it prints is compared by the test."""

from __future__ import annotations

import sys
import threading
from types import SimpleNamespace
from typing import Any

import ifgen.dynamic
import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile

OLD = "float64 speed 0.1\nstring name\nuint8 FAST=1\ngeometry_msgs/Point[<=2] way\n"
NEW = "string name\nfloat64 speed 0.1\n"
LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Slow:
    """A node whose middleware knows at first only that somebody is on a topic, as DDS on a busy machine."""

    def __init__(self, node: rclpy.node.Node) -> None:
        self.context, self._node, self._looks = node.context, node, 0

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        """The endpoints, of unknown nodes at the first two looks."""
        self._looks += 1
        found = self._node.get_publishers_info_by_topic(topic)
        if self._looks > 2:
            return found
        hidden = {"node_name": "_NODE_NAME_UNKNOWN_", "node_namespace": "_NODE_NAMESPACE_UNKNOWN_"}
        return [
            SimpleNamespace(topic_type=each.topic_type, topic_type_hash=each.topic_type_hash, **hidden)
            for each in found
        ]

    def get_subscriptions_info_by_topic(self, _: str) -> list[Any]:
        """Nobody."""
        return []


def main() -> None:
    rclpy.init()
    talker, listener = rclpy.create_node("talker", namespace="/far"), rclpy.create_node("listener")
    old = ifgen.dynamic.class_from_text("nobody_msgs/msg/Move", OLD)
    new = ifgen.dynamic.class_from_text("nobody_msgs/msg/Move", NEW)
    assert old is not new
    point = old.__nested__[0]
    publisher = talker.create_publisher(old, "move", LATCHED)
    poses = talker.create_publisher(PoseStamped, "/pose", LATCHED)
    publisher.publish(old(speed=0.1, name="far", way=[point(x=0.5, y=-0.1)]))
    pose = PoseStamped()
    pose.header.frame_id, pose.pose.position.x = "map", 0.1
    poses.publish(pose)
    executor = SingleThreadedExecutor()
    executor.add_node(talker)
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    try:
        for topic in ("/far/move", "/pose"):
            found = ifgen.dynamic.describe(listener, topic, timeout=20.0)
            print(found)
            cls = ifgen.dynamic.class_of(found)
            print(cls.__type_hash__ == found.type_hash, getattr(cls, "FAST", None), cls is old)
            print(receive(listener, cls, topic))
        wrong = {"type_hash": new.__type_hash__, "timeout": 0.2}
        for topic, options in (("/silence", {"timeout": 0.2}), ("/far/move", wrong)):
            try:
                ifgen.dynamic.describe(listener, topic, **options)
            except ifgen.dynamic.DescribeError as error:
                print(error)
        print(ifgen.dynamic.describe(Slow(listener), "/far/move").node)
        refuse(listener)
        serve(talker, listener)
    finally:
        executor.shutdown()
        rclpy.shutdown()
        spinning.join(10.0)
    print("end")


def receive(node: rclpy.node.Node, cls: type, topic: str) -> object:
    """The first message."""
    got = rclpy.Future()
    subscription = node.create_subscription(cls, topic, lambda m: got.done() or got.set_result(m), LATCHED)
    rclpy.spin_until_future_complete(node, got, timeout_sec=20.0)
    node.destroy_subscription(subscription)
    return got.result()


def refuse(listener: rclpy.node.Node) -> None:
    """Nodes that do not answer: one does not spin, one has no such service."""
    off = rclpy.Parameter("start_type_description_service", value=False)
    asleep = rclpy.create_node("asleep", start_parameter_services=False)
    mute = rclpy.create_node("mute", start_parameter_services=False, parameter_overrides=[off])
    for node in (asleep, mute):
        node.create_publisher(PoseStamped, "/quiet", 1)
    while listener.count_publishers("/quiet") < 2:
        rclpy.spin_once(listener, timeout_sec=0.1)
    try:
        ifgen.dynamic.describe(listener, "/quiet", timeout=1.0)
    except ifgen.dynamic.DescribeError as error:
        print(*sorted(str(error).split(": ", 1)[1].split("; ")), sep="\n")
    for node in (asleep, mute):
        node.destroy_node()


def serve(talker: rclpy.node.Node, listener: rclpy.node.Node) -> None:
    """A service of a type that is known at run time only."""
    text = "float64 a 0.5\n---\nfloat64 twice\n"
    double = ifgen.dynamic.class_from_text("nobody_msgs/srv/Double", text)

    def answer(request: object, response: object) -> object:
        response.twice = 2 * request.a  # type: ignore[attr-defined]
        return response

    talker.create_service(double, "/double", answer)
    client = listener.create_client(double, "/double")
    assert client.wait_for_service(20.0)
    future = client.call_async(double.Request(a=0.1))
    rclpy.spin_until_future_complete(listener, future, timeout_sec=20.0)
    print(future.result())


if __name__ == "__main__":
    sys.exit(main())
