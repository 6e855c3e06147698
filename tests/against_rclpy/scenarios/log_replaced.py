"""Loggers that a test substitutes for rclpy's: which of their methods are called, and by whom."""

import re

import rclpy
import rclpy.executors
from rclpy.action import ActionClient, ActionServer
from rclpy.experimental import EventsExecutor
from rclpy.qos import QoSProfile
from std_msgs.msg import String
from test_msgs.action import Fibonacci
from transcript import until


class Recorder:
    """A logger with the requested methods and no others, which remembers the calls."""

    def __init__(self, name: str, calls: list[str]) -> None:
        self.name, self._calls = name, calls

    def get_child(self, name: str) -> "Recorder":
        """A recorder with the same list."""
        self._calls.append(f"{self.name}: get_child {name}")
        return Recorder(f"{self.name}.{name}" if self.name else name, self._calls)

    def __getattr__(self, method: str):
        if method not in ("debug", "info", "warn", "warning", "error", "fatal"):
            raise AttributeError(method)

        def log(message: str, **kwargs: object) -> bool:
            first = re.split(r"\n|ID|\[", message)[0]  # ids are random, tracebacks name files
            self._calls.append(f"{self.name}: {method} {first} {sorted(kwargs)}")
            return True

        return log


def show(title: str, calls: list[str]) -> None:
    """Print each call once, sorted, because the order of arrival differs."""
    print(title)
    for call in sorted(set(calls)):
        print("  ", call)
    calls.clear()


def events(calls: list[str]) -> None:
    """Incompatible counterparts, with the loggers made when the endpoints are."""
    node = rclpy.create_node("events")
    volatile, transient = QoSProfile(depth=1, durability=2), QoSProfile(depth=1, durability=1)
    original, rclpy.logging._root_logger = rclpy.logging._root_logger, Recorder("", calls)
    node.create_publisher(String, "replaced", volatile)
    node.create_subscription(String, "replaced", print, transient)
    rclpy.logging._root_logger = original
    until(lambda: sum(": warn" in call for call in calls) == 2, node)
    show("events", calls)
    node.destroy_node()


def actions(calls: list[str]) -> None:
    """A goal from request to result, by a node whose `get_logger` is its own."""

    class Own(rclpy.node.Node):
        def get_logger(self) -> Recorder:
            return Recorder("own", calls)

    node = Own("actions")

    def forget(handle: object) -> Fibonacci.Result:
        return Fibonacci.Result()

    server = ActionServer(node, Fibonacci, "replaced_action", forget)
    client = ActionClient(node, Fibonacci, "replaced_action")
    client.wait_for_server(10.0)
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)

    def finish(future: rclpy.Future) -> object:
        until(future.done, executor)
        return future.result()

    goal = finish(client.send_goal_async(Fibonacci.Goal()))
    finish(goal.get_result_async())
    finish(goal.cancel_goal_async())
    server.register_goal_callback(lambda request: None)
    finish(client.send_goal_async(Fibonacci.Goal()))
    show("actions", calls)
    executor.shutdown()
    node.destroy_node()


def failing_callback(calls: list[str]) -> None:
    """A callback that raises in the executor that logs it."""
    node = rclpy.create_node("failing")
    node.get_logger = lambda: Recorder("failing", calls)  # type: ignore[method-assign]  # as tests do
    executor = EventsExecutor()
    executor.add_node(node)
    node.create_timer(0.01, lambda: 1 / 0)
    try:
        until(lambda: False, executor, seconds=5.0)
    except ZeroDivisionError as error:
        print("raised", error)
    show("failing callback", calls)
    executor.shutdown()
    node.destroy_node()


def main() -> None:
    """All of them."""
    rclpy.init()
    calls: list[str] = []
    events(calls)
    actions(calls)
    failing_callback(calls)
    rclpy.shutdown()
