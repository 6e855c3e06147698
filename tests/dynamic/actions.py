"""An action of a type that no package has: what it prints is compared by the test."""

from __future__ import annotations

import threading

import ifgen.dynamic
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor

TEXT = "int8 count\n---\nfloat64 sum\n---\nfloat64 last\n"


def main() -> None:
    rclpy.init()
    server_node, client_node = rclpy.create_node("server"), rclpy.create_node("client")
    count = ifgen.dynamic.class_from_text("nobody_msgs/action/Count", TEXT)

    def execute(goal: object) -> object:
        feedback = count.Feedback(last=0.1)
        goal.publish_feedback(feedback)  # type: ignore[attr-defined]
        goal.succeed()  # type: ignore[attr-defined]
        return count.Result(sum=0.1 * goal.request.count)  # type: ignore[attr-defined]

    server = ActionServer(server_node, count, "/count", execute)
    executor = SingleThreadedExecutor()
    executor.add_node(server_node)
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    try:
        client = ActionClient(client_node, count, "/count")
        assert client.wait_for_server(20.0)
        sent = client.send_goal_async(count.Goal(count=3), feedback_callback=lambda m: print(m.feedback))
        rclpy.spin_until_future_complete(client_node, sent, timeout_sec=20.0)
        done = sent.result().get_result_async()
        rclpy.spin_until_future_complete(client_node, done, timeout_sec=20.0)
        print(done.result().status, done.result().result)
        found = ifgen.dynamic.describe(client_node, "/count/_action/feedback", timeout=20.0)
        print(found.type_name, ifgen.dynamic.class_of(found).__type_hash__ == found.type_hash)
    finally:
        server.destroy()
        executor.shutdown()
        rclpy.shutdown()
        spinning.join(10.0)
    print("end")


if __name__ == "__main__":
    main()
