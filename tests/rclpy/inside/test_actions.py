"""Actions, in ways that only ours can be tested: virtual time, memory, many threads, garbage, example programs."""

from __future__ import annotations

import contextlib
import gc
import importlib.util
import itertools
import sys
import threading
import time
import tracemalloc
import weakref
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalInfo
from action_msgs.srv import CancelGoal
from ifgen_pytest.domains import RANGE
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse, get_action_names_and_types
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from rosgraph_msgs.msg import Clock
from test_msgs.action import Fibonacci
from test_msgs.msg import Empty
from unique_identifier_msgs.msg import UUID

_domains = itertools.count(1)
EXAMPLES = Path(__file__).parents[3] / "examples" / "action"


@pytest.fixture(autouse=True)
def _context(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A domain for each test: entities left by one test are not in the graph of another. No process shares it."""
    monkeypatch.setenv(RANGE, "OFF")
    rclpy.init(domain_id=next(_domains))
    yield
    rclpy.try_shutdown()


def succeed(handle: ServerGoalHandle) -> Any:
    """Succeed at once."""
    handle.succeed()
    return Fibonacci.Result(sequence=[handle.request.order])


class Scene:
    """A node with an action server and a client in a single-threaded executor."""

    def __init__(self, execute: Any = succeed, **options: Any) -> None:
        self.node = Node("actor")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.server = ActionServer(self.node, Fibonacci, "fib", execute, **options)
        self.client = ActionClient(self.node, Fibonacci, "fib")

    def finish(self, future: Future) -> Any:
        """Spin until the future is done."""
        self.executor.spin_until_future_complete(future, timeout_sec=20)
        assert future.done()
        return future.result()

    def goal(self, order: int = 1, number: int | None = None, **options: Any) -> Any:
        """Send a goal and return its handle."""
        goal_id = None if number is None else UUID(uuid=[number] * 16)
        return self.finish(
            self.client.send_goal_async(Fibonacci.Goal(order=order), goal_uuid=goal_id, **options)
        )

    def spin_while_ready(self) -> None:
        """Do everything that can be done now."""
        for _ in range(20):
            self.executor.spin_once(timeout_sec=0)


def test_results_expire_by_the_nodes_clock() -> None:
    """With simulated time, a result remains while /clock stands still, and expires when it has advanced enough."""
    scene = Scene(result_timeout=10)
    clock = scene.node.create_publisher(Clock, "/clock", 10)
    scene.node.set_parameters([Parameter("use_sim_time", value=True)])

    def show(seconds: int) -> None:
        message = Clock()
        message.clock.sec = seconds
        clock.publish(message)
        scene.spin_while_ready()

    show(1000)
    handle = scene.goal(number=1)
    assert handle.stamp.sec == 1000
    assert scene.finish(handle.get_result_async()).status == 4
    show(1009)
    assert scene.finish(handle.get_result_async()).status == 4
    assert not scene.goal(number=1).accepted
    show(1010)
    assert scene.finish(handle.get_result_async()).status == 0
    assert scene.goal(number=1).accepted


def test_a_goal_may_expire_before_its_callback_returns() -> None:
    """Whoever has asked still gets the result, of a goal that is now unknown; the real one raises out of spin."""
    go_on = Future()

    async def execute(handle: ServerGoalHandle) -> Any:
        handle.succeed()
        await go_on
        return Fibonacci.Result(sequence=[6])

    scene = Scene(execute, result_timeout=0.2)
    result = scene.goal().get_result_async()
    while scene.server._goal_handles:
        scene.executor.spin_once(timeout_sec=0.01)
    go_on.set_result(None)
    response = scene.finish(result)
    assert (response.status, list(response.result.sequence)) == (0, [6])


def test_every_goal_is_asked_about_when_all_are_to_be_cancelled() -> None:
    """The response lists exactly the goals that will be cancelled; the real one skips goals after a refusal."""
    waiting: list[ServerGoalHandle] = []
    asked: list[int] = []

    def may_cancel(handle: ServerGoalHandle) -> CancelResponse:
        asked.append(handle.request.order)
        return CancelResponse.ACCEPT if handle.request.order % 2 else CancelResponse.REJECT

    scene = Scene(handle_accepted_callback=waiting.append, cancel_callback=may_cancel)
    for order in range(5):
        scene.goal(order, number=order + 1)
    raw = scene.node.create_client(CancelGoal, "fib/_action/cancel_goal")
    response = scene.finish(raw.call_async(CancelGoal.Request(goal_info=GoalInfo())))
    assert asked == [0, 1, 2, 3, 4]
    assert [int(info.goal_id.uuid[0]) for info in response.goals_canceling] == [2, 4]
    assert [handle.is_cancel_requested for handle in waiting] == [False, True, False, True, False]


def test_no_action_type_is_refused_with_its_name() -> None:
    """The real one crashes here."""
    node = Node("actor")
    for make in (lambda: ActionServer(node, Empty, "x", succeed), lambda: ActionClient(node, Empty, "x")):
        with pytest.raises(RuntimeError, match=r"The action type provided is not valid .*Empty"):
            make()
    assert get_action_names_and_types(node) == []


def test_what_cannot_be_sent_is_refused_and_leaves_nothing_pending() -> None:
    """A wrong field value raises in the call that sends it."""
    scene = Scene()
    pending = len(scene.client._pending_goal_requests)
    with pytest.raises(Exception, match="order"):
        scene.client.send_goal_async(Fibonacci.Goal(order="five"))
    assert len(scene.client._pending_goal_requests) == pending
    assert scene.finish(scene.goal().get_result_async()).status == 4


def test_a_future_given_up_is_forgotten() -> None:
    """The response to a withdrawn request is not an error; its goal runs anyway."""
    ran = []
    scene = Scene(lambda handle: (ran.append(1), succeed(handle))[1])
    future = scene.client.send_goal_async(Fibonacci.Goal())
    future.cancel()
    assert not scene.client._pending_goal_requests
    scene.spin_while_ready()
    assert ran == [1]
    assert scene.finish(scene.goal().get_result_async()).status == 4


@pytest.mark.slow
def test_memory_is_flat() -> None:
    """Thousands of goals leave nothing once their results have expired, nor do rejected ones."""
    scene = Scene(
        result_timeout=0,
        goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order else GoalResponse.REJECT,
    )

    def play(count: int) -> None:
        for _ in range(count):
            assert not scene.goal(0, feedback_callback=lambda message: None).accepted
            handle = scene.goal(feedback_callback=lambda message: None)
            scene.finish(handle.get_result_async())
        scene.spin_while_ready()

    play(100)
    gc.collect()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    play(1000)
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 60_000
    assert not scene.server._goal_handles
    assert not scene.server._result_futures
    assert not scene.server._futures
    assert not scene.client._futures
    assert not scene.client._feedback_callbacks


def test_forgotten_actions_leave_the_graph_and_memory() -> None:
    """Nobody called destroy."""
    watcher = Node("watcher")
    node = Node("actor")
    server = ActionServer(node, Fibonacci, "fib", succeed)
    client = ActionClient(node, Fibonacci, "fib")
    assert get_action_names_and_types(watcher) == [("/fib", ["test_msgs/action/Fibonacci"])]
    references = [weakref.ref(server), weakref.ref(client)]
    node.destroy_node()
    del server, client, node
    gc.collect()
    assert [reference() for reference in references] == [None, None]
    assert get_action_names_and_types(watcher) == []


def test_a_failed_construction_leaves_nothing() -> None:
    """If the fourth part cannot be made, the first three are gone too."""
    node = Node("actor")
    node.create_publisher(Empty, "fib/_action/feedback", 10)
    services = node.get_service_names_and_types()
    # The exception is kept, and its traceback keeps everything that was made.
    with pytest.raises(ValueError, match=r"Failed to create action server: .*feedback") as kept:
        ActionServer(node, Fibonacci, "fib", succeed)
    assert node.get_service_names_and_types() == services
    del kept


def test_goals_from_many_threads() -> None:
    """Eight threads send goals and wait; every one gets its own result, feedback and final status."""
    count, threads = 25, 8
    node, other = Node("serving"), Node("asking")
    group = ReentrantCallbackGroup()

    def execute(handle: ServerGoalHandle) -> Any:
        handle.publish_feedback(Fibonacci.Feedback(sequence=[handle.request.order]))
        return succeed(handle)

    server = ActionServer(node, Fibonacci, "fib", execute, callback_group=group)
    client = ActionClient(other, Fibonacci, "fib", callback_group=ReentrantCallbackGroup())
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    executor.add_node(other)
    spinner = threading.Thread(target=executor.spin, daemon=True)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    wrong: list[Any] = []
    heard: list[int] = []

    def ask(thread: int) -> None:
        for number in range(count):
            order = thread * 1000 + number
            response = client.send_goal(
                Fibonacci.Goal(order=order),
                feedback_callback=lambda message, order=order: heard.append(
                    order - message.feedback.sequence[0]
                ),
            )
            if response.status != 4 or list(response.result.sequence) != [order]:
                wrong.append((order, response))

    askers = [threading.Thread(target=ask, args=(thread,), daemon=True) for thread in range(threads)]
    try:
        spinner.start()
        for asker in askers:
            asker.start()
        for asker in askers:
            asker.join(40)
            assert not asker.is_alive()
    finally:
        sys.setswitchinterval(interval)
        executor.shutdown()
        spinner.join(10)
    assert wrong == []
    assert set(heard) <= {0}
    assert not client._pending_goal_requests
    server.destroy()


def test_servers_and_clients_come_and_go_while_spinning() -> None:
    """One thread makes and destroys actions with running goals; the other spins without an error."""
    node = Node("actor")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    done = threading.Event()
    errors: list[BaseException] = []

    def churn() -> None:
        try:
            for number in range(60):
                server = ActionServer(node, Fibonacci, f"fib{number % 3}", succeed)
                client = ActionClient(node, Fibonacci, f"fib{number % 3}")
                future = client.send_goal_async(Fibonacci.Goal(order=number))
                if number % 2:
                    end = time.monotonic() + 10
                    while not future.done() and time.monotonic() < end:
                        time.sleep(0.0005)
                client.destroy()
                server.destroy()
        except BaseException as error:
            errors.append(error)
        finally:
            done.set()
            executor.wake()

    worker = threading.Thread(target=churn, daemon=True)
    worker.start()
    while not done.is_set():
        # As with the real one: an entity destroyed between a request and its answer raises out of spin.
        with contextlib.suppress(InvalidHandle, _rclpy.RCLError):
            executor.spin_once(timeout_sec=0.05)
    worker.join(10)
    assert errors == []
    assert get_action_names_and_types(node) == []


def test_what_is_destroyed_after_it_was_found_ready_is_left_alone() -> None:
    """Another callback of the same round destroys it before its turn."""
    scene = Scene()
    scene.client.send_goal_async(Fibonacci.Goal())
    assert scene.server._find_ready()
    scene.server.destroy()
    assert scene.server.take_data() == {}
    with pytest.raises(InvalidHandle), scene.server:
        pass
    served = ActionServer(scene.node, Fibonacci, "fib", succeed)
    future = scene.client.send_goal_async(Fibonacci.Goal())
    while not scene.client._find_ready():
        scene.executor.spin_once(timeout_sec=0)
    scene.client.destroy()
    assert scene.client.take_data() == {}
    assert not future.done()
    served.destroy()


def test_a_response_that_comes_before_send_goal_returns_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another thread receives the response before this one has noted what it waits for."""
    node = Node("actor")
    server = ActionServer(node, Fibonacci, "fib", succeed)
    client = ActionClient(node, Fibonacci, "fib")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    answered = threading.Event()
    send = client._client_handle.send_goal_request

    def slowly(request: Any) -> int:
        number: int = send(request)
        answered.wait(0.2)
        return number

    class Futures(list[Future]):
        """Reports when a future is removed from it."""

        def remove(self, future: Future) -> None:
            answered.set()
            super().remove(future)

    def spin() -> None:
        while not answered.is_set():
            executor.spin_once(timeout_sec=0.01)

    client._futures = Futures()
    monkeypatch.setattr(client._client_handle, "send_goal_request", slowly)
    spinner = threading.Thread(target=spin, daemon=True)
    spinner.start()
    future = client.send_goal_async(Fibonacci.Goal())
    assert answered.wait(5)
    spinner.join(5)
    executor.spin_until_future_complete(future, timeout_sec=5)
    assert future.done()
    server.destroy()


def _example(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("order", "cancel_after", "expected"),
    [(4, None, "succeeded: [0, 1, 1, 2, 3]"), (40, 2, "canceled: [0, 1, 1, 2"), (99, None, "rejected")],
)
def test_examples(
    order: int, cancel_after: int | None, expected: str, capfd: pytest.CaptureFixture[str], monkeypatch: Any
) -> None:
    """Server and client talk, and the client ends the program."""
    server_module, client_module = _example("fibonacci_server"), _example("fibonacci_client")
    monkeypatch.setattr(server_module, "STEP", 0.01)
    server, client = server_module.FibonacciServer(), client_module.FibonacciClient(cancel_after)
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(server)
    executor.add_node(client)
    client.send_goal(order)
    executor.spin()
    assert not rclpy.ok()
    assert expected in capfd.readouterr().err
