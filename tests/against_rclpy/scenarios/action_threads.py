"""Concurrent goals, calls that wait, results that expire, and servers that go in the middle of work."""

import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.task import Future
from test_msgs.action import Fibonacci
from transcript import attempt, spin_for, until
from unique_identifier_msgs.msg import UUID


def result(*numbers):
    return Fibonacci.Result(sequence=list(numbers))


class Spinning:
    """An executor that spins on a thread of its own."""

    def __init__(self, *nodes, threads=4):
        self.executor = MultiThreadedExecutor(threads)
        for node in nodes:
            self.executor.add_node(node)
        self.thread = threading.Thread(target=self.executor.spin, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self.executor

    def __exit__(self, *error):
        self.executor.shutdown()
        self.thread.join(10.0)
        print("thread ended", not self.thread.is_alive())


def waiting_calls(node):
    """send_goal, get_result and cancel_goal wait for messages that another thread receives."""
    heard = []

    def execute(handle):
        if handle.request.order < 0:
            while not handle.is_cancel_requested:
                time.sleep(0.005)
            handle.canceled()
            return result(-1)
        # Real ROS reports a server as ready before everybody receives its feedback.
        for _ in range(2000):
            handle.publish_feedback(Fibonacci.Feedback(sequence=[1]))
            if heard:
                break
            time.sleep(0.005)
        handle.succeed()
        return result(handle.request.order)

    server = ActionServer(
        node,
        Fibonacci,
        "waiting",
        execute,
        callback_group=ReentrantCallbackGroup(),
        cancel_callback=lambda handle: CancelResponse.ACCEPT,
    )
    client = ActionClient(node, Fibonacci, "waiting", callback_group=ReentrantCallbackGroup())
    with Spinning(node) as executor:
        print("found", client.wait_for_server(10.0))
        ended = client.send_goal(Fibonacci.Goal(order=3), feedback_callback=heard.append)
        print("send_goal", type(ended).__name__, ended.status, ended.result.sequence)
        attempt("unknown argument", lambda: client.send_goal(Fibonacci.Goal(), colour=1), type)
        future = client.send_goal_async(Fibonacci.Goal(order=-1))
        until(future.done)
        handle = future.result()
        until(lambda: handle.status == GoalStatus.STATUS_EXECUTING)
        response = handle.cancel_goal()
        print("cancel_goal", response.return_code, len(response.goals_canceling))
        ended = handle.get_result()
        print("get_result", ended.status, ended.result.sequence)
        print("heard", until(lambda: heard), executor is node.executor)
    client.destroy()
    server.destroy()


def side_by_side(node):
    """As many goals execute at once as there are threads; execute callbacks belong to no group."""
    together = threading.Barrier(3)

    def execute(handle):
        together.wait(10.0)
        handle.succeed()
        return result(handle.request.order)

    server = ActionServer(node, Fibonacci, "many", execute, callback_group=MutuallyExclusiveCallbackGroup())
    client = ActionClient(node, Fibonacci, "many")
    with Spinning(node, threads=5):
        client.wait_for_server(10.0)
        futures = [client.send_goal_async(Fibonacci.Goal(order=number)) for number in range(3)]
        until(lambda: all(future.done() for future in futures))
        results = [future.result().get_result_async() for future in futures]
        until(lambda: all(future.done() for future in results))
        print("results", sorted(list(future.result().result.sequence) for future in results))
    client.destroy()
    server.destroy()


def one_at_a_time(node):
    """A server as in the tutorials: the newest goal takes over, the older is aborted."""
    current = []
    lock = threading.Lock()

    def accepted(handle):
        with lock:
            if current and current[-1].is_active:
                current[-1].abort()
            current.append(handle)
        handle.execute()

    def execute(handle):
        for _ in range(2000):
            if not handle.is_active:
                print("taken over", handle.status)
                return result()
            if handle.request.order == 2:
                handle.succeed()
                return result(2)
            time.sleep(0.005)
        return result(0)

    server = ActionServer(
        node,
        Fibonacci,
        "single",
        execute,
        handle_accepted_callback=accepted,
        callback_group=ReentrantCallbackGroup(),
    )
    client = ActionClient(node, Fibonacci, "single")
    with Spinning(node):
        client.wait_for_server(10.0)
        first = client.send_goal_async(Fibonacci.Goal(order=1))
        until(first.done)
        first_result = first.result().get_result_async()
        until(lambda: first.result().status == GoalStatus.STATUS_EXECUTING)
        second = client.send_goal_async(Fibonacci.Goal(order=2))
        until(second.done)
        second_result = second.result().get_result_async()
        until(lambda: first_result.done() and second_result.done())
        print("first", first_result.result().status, "second", second_result.result().status)
    client.destroy()
    server.destroy()


def awaiting(node):
    """Coroutines on one thread: a goal that sends a goal to another action and awaits its result."""

    async def outer(handle):
        inner_handle = await inner_client.send_goal_async(Fibonacci.Goal(order=handle.request.order + 1))
        inner_result = await inner_handle.get_result_async()
        handle.succeed()
        return result(handle.request.order, *inner_result.result.sequence)

    async def inner(handle):
        handle.succeed()
        return result(handle.request.order)

    servers = [ActionServer(node, Fibonacci, "outer", outer), ActionServer(node, Fibonacci, "inner", inner)]
    client = ActionClient(node, Fibonacci, "outer")
    inner_client = ActionClient(node, Fibonacci, "inner")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    client.wait_for_server(10.0)
    inner_client.wait_for_server(10.0)
    future = client.send_goal_async(Fibonacci.Goal(order=40))
    executor.spin_until_future_complete(future, 10.0)
    future = future.result().get_result_async()
    executor.spin_until_future_complete(future, 10.0)
    print("nested", future.result().status, future.result().result.sequence)
    for each in (client, inner_client, *servers):
        each.destroy()
    executor.shutdown()


def expiring(node):
    """Results are kept for a while after the end, not after acceptance."""
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    go_on = Future()

    async def execute(handle):
        if handle.request.order:
            await go_on
        handle.succeed()
        return result(handle.request.order)

    server = ActionServer(node, Fibonacci, "brief", execute, result_timeout=0.6)
    client = ActionClient(node, Fibonacci, "brief")
    client.wait_for_server(10.0)

    def finish(future):
        until(future.done, executor)
        return future.result()

    def send(order, number):
        return finish(client.send_goal_async(Fibonacci.Goal(order=order), None, UUID(uuid=[number] * 16)))

    def ended(handle):
        return finish(handle.get_result_async()).status

    quick, slow = send(0, 1), send(1, 2)
    print("quick", ended(quick), ended(quick))
    spin_for(1.2, executor)
    ended(quick)  # before 7.1.9 the goal that waits kept the executor busy, and the result was still there
    print("tracked", len(server._goal_handles))
    go_on.set_result(None)
    print("slow", ended(slow), ended(slow))
    print("id is free", send(0, 1).accepted, "not this", send(0, 2).accepted)
    spin_for(1.2, executor)
    print("expired", ended(slow), "tracked", len(server._goal_handles))
    server.destroy()
    client.destroy()
    executor.shutdown()


def destroyed_while_running(node):
    """The server is destroyed while a goal executes: nothing breaks, and there is no result.

    Ours deliberately differs: the future of the result fails.
    """
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    go_on = Future()
    said = []

    async def execute(handle):
        await go_on
        said.append((handle.status, handle.is_active))
        handle.succeed()
        handle.publish_feedback(Fibonacci.Feedback())
        said.append("done")
        return result()

    server = ActionServer(node, Fibonacci, "dying", execute)
    client = ActionClient(node, Fibonacci, "dying")
    client.wait_for_server(10.0)
    future = client.send_goal_async(Fibonacci.Goal())
    until(future.done, executor)
    pending = future.result().get_result_async()
    until(lambda: future.result().status == GoalStatus.STATUS_EXECUTING, executor)
    spin_for(0.1, executor)
    server.destroy()
    go_on.set_result(None)
    until(lambda: len(said) == 2, executor)
    spin_for(0.1, executor)
    print(said, "has a result", pending.done() and pending.exception() is None)
    until(lambda: not client.server_is_ready(), executor)
    print("server gone", client.server_is_ready())
    client.destroy()
    executor.shutdown()


def without_executor(node):
    """A goal can only be executed while its node is in an executor."""
    held = []
    server = ActionServer(node, Fibonacci, "lonely", print, handle_accepted_callback=held.append)
    client = ActionClient(node, Fibonacci, "lonely")
    client.wait_for_server(10.0)
    future = client.send_goal_async(Fibonacci.Goal())
    rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
    print("accepted", future.result().accepted)
    node.executor = None
    attempt("execute", held[0].execute)
    server.destroy()
    client.destroy()


def main() -> None:
    """Play every case."""
    rclpy.init()
    node = rclpy.create_node("actor")
    for case in (
        waiting_calls,
        side_by_side,
        one_at_a_time,
        awaiting,
        expiring,
        destroyed_while_running,
        without_executor,
    ):
        print(f"--- {case.__name__}")
        case(node)
    rclpy.shutdown()
