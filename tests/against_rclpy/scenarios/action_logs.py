"""The log lines of actions, as published on /rosout."""

import rclpy
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity, set_logger_level
from test_msgs.action import Fibonacci
from transcript import until
from unique_identifier_msgs.msg import UUID


def show(logs):
    """Print each line of the action loggers once."""
    shown = set()
    for log in logs:
        line = f"{log.level} {log.name}: {' '.join(log.msg.split())}"
        # The number of goals sent before the warning depends on discovery.
        sent_meanwhile = any(f"[{number} " in line for number in range(10, 30))
        if log.name.startswith("actor.action_") and line not in shown and not sent_meanwhile:
            print(line)
        shown.add(line)


def main() -> None:
    """Warnings, errors, and what debugging adds."""
    rclpy.init()
    node = rclpy.create_node("actor")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    logs = []
    node.create_subscription(Log, "/rosout", logs.append, 1000)

    def raises(handle):
        raise ValueError("boom")

    def forgets(handle):
        return Fibonacci.Result()

    def succeeds(handle):
        handle.succeed()
        return Fibonacci.Result()

    server = ActionServer(node, Fibonacci, "fib", succeeds)
    client = ActionClient(node, Fibonacci, "fib")
    raw = node.create_client(Fibonacci.Impl.GetResultService, "fib/_action/get_result")
    client.wait_for_server(10.0)
    raw.wait_for_service(10.0)
    until(lambda: node.count_publishers("/rosout") >= 1, executor)
    set_logger_level("actor.action_server", LoggingSeverity.DEBUG)
    set_logger_level("actor.action_client", LoggingSeverity.DEBUG)

    def finish(future):
        until(future.done, executor)
        return future.result()

    def goal(number):
        return finish(client.send_goal_async(Fibonacci.Goal(), None, UUID(uuid=[number] * 16)))

    for number, execute in enumerate((succeeds, raises, forgets), start=1):
        server.register_execute_callback(execute)
        handle = goal(number)
        finish(handle.get_result_async())
        finish(handle.cancel_goal_async())
    server.register_goal_callback(lambda goal: None)
    goal(4)
    server.register_goal_callback(lambda goal: GoalResponse.REJECT)
    goal(5)
    finish(raw.call_async(Fibonacci.Impl.GetResultService.Request()))

    # A second server answers as well.
    server.register_goal_callback(None)
    server.register_execute_callback(succeeds)
    second = ActionServer(
        node,
        Fibonacci,
        "fib",
        succeeds,
        goal_callback=lambda goal: GoalResponse.REJECT,
    )
    until(lambda: node.count_publishers("/fib/_action/status") == 2, executor)

    for number in range(10, 30):  # until the client has found both servers
        goal(number)
        if until(lambda: any("unexpected" in log.msg for log in logs), executor, seconds=0.5):
            break
    second.destroy()

    show(logs)
    rclpy.shutdown()
