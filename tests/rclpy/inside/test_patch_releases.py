"""What Jazzy's patch releases brought after the wheels: rclpy 7.1.8 to 7.1.12, rcl 9.2.8."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import parameter_dict_from_yaml_file, parameter_value_to_python
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Empty
from test_msgs.action import Fibonacci

EXECUTORS = [SingleThreadedExecutor, lambda: MultiThreadedExecutor(num_threads=3), EventsExecutor]
IDS = ["single", "multi", "events"]


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    node = rclpy.create_node("n")
    yield node
    rclpy.try_shutdown()


class Goals:
    """An action server without execute callback, the goals that it has accepted, and a client."""

    def __init__(self, node: Node, **options: Any) -> None:
        self.node = node
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(node)
        self.handles: list[Any] = []

        def keep(handle: Any) -> None:
            self.handles.append(handle)
            handle.execute()

        self.server = ActionServer(node, Fibonacci, "f", handle_accepted_callback=keep, **options)
        self.client = ActionClient(node, Fibonacci, "f")

    def finish(self, future: Future[Any]) -> Any:
        """Spin until the future is done."""
        self.executor.spin_until_future_complete(future, timeout_sec=10)
        assert future.done()
        return future.result()

    def goal(self) -> tuple[Any, Any]:
        """Send a goal; returns the handles of the client and of the server."""
        return self.finish(self.client.send_goal_async(Fibonacci.Goal(order=1))), self.handles[-1]


def test_a_goal_without_callback_ends_when_the_program_says_so(node: Node) -> None:
    goals = Goals(node, cancel_callback=lambda _: CancelResponse.ACCEPT)
    mine, theirs = goals.goal()
    assert theirs.status == GoalStatus.STATUS_EXECUTING
    result = mine.get_result_async()
    thread = threading.Thread(target=theirs.succeed, args=(Fibonacci.Result(sequence=[1, 2]),))
    thread.start()
    answer = goals.finish(result)
    thread.join()
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_SUCCEEDED, [1, 2])
    mine, theirs = goals.goal()
    theirs.abort()
    answer = goals.finish(mine.get_result_async())
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_ABORTED, [])
    mine, theirs = goals.goal()
    goals.finish(mine.cancel_goal_async())
    theirs.canceled(Fibonacci.Result(sequence=[3]))
    assert list(goals.finish(mine.get_result_async()).result.sequence) == [3]
    with pytest.raises(TypeError, match=r"expected Fibonacci_Result, got str"):
        theirs.succeed("done")


@pytest.mark.parametrize(("response", "sequence"), [(None, [7]), (Fibonacci.Result(sequence=[1]), [1])])
def test_the_first_result_of_a_callback_wins(node: Node, response: Any, sequence: list[int]) -> None:
    goals = Goals(node)

    def execute(handle: Any) -> Any:
        handle.succeed(response)
        return Fibonacci.Result(sequence=[7])

    goals.server.register_execute_callback(execute)
    mine, _ = goals.goal()
    assert list(goals.finish(mine.get_result_async()).result.sequence) == sequence


def test_the_name_of_an_action_is_remapped() -> None:
    rclpy.init()
    node = rclpy.create_node("n", cli_args=["--ros-args", "-r", "fib:=/other", "-r", "n:/x:=topic"])
    ActionServer(node, Fibonacci, "fib", lambda _: Fibonacci.Result())
    names = {name for name, _ in node.get_service_names_and_types()}
    assert "/other/_action/send_goal" in names
    rclpy.try_shutdown()


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
@pytest.mark.parametrize("end", ["result", "exception", "cancel"])
def test_another_thread_wakes_what_awaits_its_future(node: Node, make_executor: Any, end: str) -> None:
    executor: Executor = make_executor()
    executor.add_node(node)
    future: Future[int] = Future()
    steps: list[int] = []

    async def work() -> Any:
        steps.append(1)
        return await future

    task = executor.create_task(work)
    ending: dict[str, Callable[[], object]] = {
        "result": lambda: future.set_result(42),
        "exception": lambda: future.set_exception(ValueError("late")),
        "cancel": future.cancel,
    }
    timer = threading.Timer(0.05, ending[end])
    timer.start()
    try:
        with pytest.warns(UserWarning) if end == "cancel" else pytest.MonkeyPatch.context():
            executor.spin_until_future_complete(task, timeout_sec=10)
            assert task.done()
    except ValueError as error:
        assert end == "exception" and str(error) == "late"
    timer.join()
    assert steps == [1]
    if end == "result":
        assert task.result() == 42
    elif end == "exception":
        assert isinstance(task.exception(), ValueError)
    executor.shutdown()


def test_a_pool_is_joined_unless_the_caller_says_no(node: Node) -> None:
    executor, gate, done = MultiThreadedExecutor(num_threads=2), threading.Event(), []
    executor.add_node(node)

    def work() -> None:
        gate.wait(10)
        done.append(1)

    executor.create_task(work)
    executor.spin_once(timeout_sec=1)
    executor.shutdown(wait_for_threads=False)
    assert not done
    gate.set()
    executor.shutdown()
    assert done == [1]
    with pytest.raises(TypeError):
        SingleThreadedExecutor().shutdown(wait_for_threads=False)  # type: ignore[call-arg]


def _entities(node: Node) -> dict[str, Callable[[], Callable[[], object]]]:
    """Functions that create an entity which has something to do, and return how to destroy it."""
    group = ReentrantCallbackGroup()
    node.create_service(Empty, "s", lambda _, response: response, callback_group=group)
    publisher = node.create_publisher(String, "t", 10)

    def subscription() -> Callable[[], object]:
        events = SubscriptionEventCallbacks(matched=lambda _: None)
        made = node.create_subscription(
            String, "t", lambda _: None, 1, callback_group=group, event_callbacks=events
        )
        publisher.publish(String())
        return lambda: node.destroy_subscription(made)

    def eventful() -> Callable[[], object]:
        events = PublisherEventCallbacks(matched=lambda _: None)
        made = node.create_publisher(String, "t", 1, event_callbacks=events)
        return lambda: node.destroy_publisher(made)

    def client() -> Callable[[], object]:
        made = node.create_client(Empty, "s", callback_group=group)
        made.call_async(Empty.Request())
        return lambda: node.destroy_client(made)

    def timer() -> Callable[[], object]:
        made = node.create_timer(0.0, lambda: None, callback_group=group)
        return lambda: node.destroy_timer(made)

    def guard() -> Callable[[], object]:
        made = node.create_guard_condition(lambda: None, callback_group=group)
        made.trigger()
        return lambda: node.destroy_guard_condition(made)

    def action() -> Callable[[], object]:
        server = ActionServer(node, Fibonacci, "g", _succeed, callback_group=group)
        made = ActionClient(node, Fibonacci, "g", callback_group=group)
        made.send_goal_async(Fibonacci.Goal())
        return lambda: (server.destroy(), made.destroy())

    def by_its_callback() -> Callable[[], object]:
        heard = threading.Event()

        def destroy(_: String) -> None:
            node.destroy_subscription(made)
            heard.set()

        events = SubscriptionEventCallbacks(matched=lambda _: None)
        made = node.create_subscription(String, "once", destroy, 1, event_callbacks=events)
        once.publish(String())
        return lambda: heard.wait(10)

    def service() -> Callable[[], object]:
        made = node.create_service(Empty, "s2", lambda _, response: response, callback_group=group)
        asking = node.create_client(Empty, "s2", callback_group=group)
        asking.call_async(Empty.Request())
        return lambda: (node.destroy_service(made), node.destroy_client(asking))

    def another_node() -> Callable[[], object]:
        other = rclpy.create_node("other")
        events = SubscriptionEventCallbacks(matched=lambda _: None)
        other.create_timer(0.0, lambda: None)
        other.create_subscription(String, "t", lambda _: None, 1, event_callbacks=events)
        assert node.executor is not None
        node.executor.add_node(other)
        publisher.publish(String())
        return other.destroy_node

    once = node.create_publisher(String, "once", 1)
    kinds = (subscription, eventful, by_its_callback, client, service, timer, guard, action, another_node)
    return {each.__name__: each for each in kinds}


_KINDS = [
    "subscription",
    "eventful",
    "by_its_callback",
    "client",
    "service",
    "timer",
    "guard",
    "action",
    "another_node",
]


def _succeed(handle: Any) -> Any:
    handle.publish_feedback(Fibonacci.Feedback())
    if handle.is_active:
        handle.succeed()
    return Fibonacci.Result()


@pytest.mark.slow
@pytest.mark.parametrize("make_executor", EXECUTORS[:2], ids=IDS[:2])
@pytest.mark.parametrize("kind", _KINDS)
def test_destruction_while_another_thread_spins(node: Node, kind: str, make_executor: Any) -> None:
    executor: Executor = make_executor()
    executor.add_node(node)
    create, faults = _entities(node)[kind], []

    def spin() -> None:
        try:
            executor.spin()
        except BaseException as error:
            faults.append(error)

    thread = threading.Thread(target=spin)
    thread.start()
    for _ in range(400):
        if faults:
            break
        create()()
    executor.shutdown()
    thread.join(10)
    assert not faults


_FILE = """
/**:
  ros__parameters: {a: 1}
  pump:
    ros__parameters: {b: 2}
/*/pump:
  ros__parameters: {b: 3}
/ns/pump:
  ros__parameters: {b: 4}
ns:
  pump:
    ros__parameters: {c: 5}
"""


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((True, ["/ns/pump"]), {"a": 1, "b": 4, "c": 5}),
        ((False, ["/x/pump"]), {"b": 3}),
        ((False, ["/x/y/pump"]), {"b": 2}),
        ((False, None), {"b": 4, "c": 5}),
    ],
)
def test_sections_of_a_parameter_file(tmp_path: Path, arguments: Any, expected: dict[str, int]) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(_FILE)
    found = parameter_dict_from_yaml_file(str(path), *arguments)
    assert {name: parameter_value_to_python(each.value) for name, each in found.items()} == expected


@pytest.mark.parametrize("order", [("g", "s"), ("s", "g")])
def test_wildcard_sections_in_either_order(tmp_path: Path, order: tuple[str, str]) -> None:
    parts = {"g": "  ros__parameters: {g: 1}\n", "s": "  shown:\n    ros__parameters: {s: 2}\n"}
    path = tmp_path / "p.yaml"
    path.write_text("/**:\n" + "".join(parts[each] for each in order))
    rclpy.init(args=["--ros-args", "--params-file", str(path)])
    node = rclpy.create_node("shown", automatically_declare_parameters_from_overrides=True)
    assert [node.get_parameter(name).value for name in ("g", "s")] == [1, 2]
    rclpy.try_shutdown()
