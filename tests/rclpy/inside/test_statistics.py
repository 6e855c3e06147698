"""What a process tells another one of itself, and that nothing is measured for nobody."""

from __future__ import annotations

import json
import threading
import time
from typing import Any

import pytest
from rclpy._executor.callback_runner import CallbackRunner
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rmw_local import statistics
from rmw_local.domain import Domain
from rmw_local.statistics import survey
from std_msgs.msg import String

from tests.rclpy.inside.contract.processes import Pair, Process

LIMIT = 10.0  # [s]


def asked(pair: Pair, process: Process) -> list[dict[str, Any]]:
    """What all processes answer to this one, itself first, without spinning."""
    come = survey(process.domain, LIMIT)
    answers: list[bytes] = []
    end = time.monotonic() + LIMIT
    while len(answers) < len(pair.processes):
        assert time.monotonic() < end, "not all processes have answered"
        answers.extend(come())
        time.sleep(0.001)
    return [json.loads(answer) for answer in answers]


def figures(node: Node) -> dict[str, Any]:
    """Those of this process alone."""
    (answer,) = survey(Domain.numbered(node.context.get_domain_id()), LIMIT)()
    found: dict[str, Any] = json.loads(answer)
    return found


@pytest.fixture(autouse=True)
def _no_answer_is_old(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statistics, "_FRESH", 0.0)


def test_processes_tell_of_nodes_topics_and_executors(across: Pair) -> None:
    one, other = across.process("one"), across.process("two")
    publisher = other.node.create_publisher(String, "word", 10)
    other.node.create_subscription(String, "word", lambda _: None, 4)
    across.until(lambda: "two" in one.node.get_node_names())
    asked(across, one)
    for _ in range(6):
        publisher.publish(String(data="word"))
    mine, theirs = asked(across, one)
    assert mine["nodes"] == ["/one"]
    assert (theirs["version"], theirs["nodes"], theirs["omitted"]) == (1, ["/two"], 0)
    published = {each["topic"]: each["published"] for each in theirs["publishers"]}
    assert published["/word"] == 6
    (subscription,) = theirs["subscriptions"]
    assert (subscription["node"], subscription["topic"]) == ("/two", "/word")
    assert [subscription[name] for name in ("waiting", "depth", "lost", "overwritten")] == [4, 4, 0, 2]
    (executor,) = theirs["executors"]
    assert (executor["kind"], executor["nodes"], executor["threads"]) == (
        "SingleThreadedExecutor",
        ["/two"],
        1,
    )


def test_nothing_is_measured_before_a_question_and_after_the_last_one(
    recorded: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(statistics, "LEASE", 0.1)
    process = recorded.process("one")
    subscription = process.node.create_subscription(String, "word", lambda _: None, 1)
    reader = subscription.handle.reader

    def is_measured() -> bool:
        return type(process.executor._runner) is not CallbackRunner or not reader._plain

    assert not is_measured()
    asked(recorded, process)
    assert type(process.executor._runner) is not CallbackRunner
    assert not reader._plain
    recorded.until(lambda: type(process.executor._runner) is CallbackRunner and reader._plain)
    asked(recorded, process)  # and again
    assert is_measured()
    recorded.until(lambda: not is_measured())


@pytest.fixture
def alone() -> Any:
    """A node whose process is in no network."""
    context = Context()
    domain = Domain.numbered(2000)
    domain.discovery = object()  # type: ignore[assignment]  # nobody is looked for
    context.init(args=[], domain_id=domain.number, initialize_logging=False)
    node = Node("alone", namespace="/here", context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.parametrize(
    "make",
    [SingleThreadedExecutor, EventsExecutor, lambda context: MultiThreadedExecutor(2, context=context)],
)
def test_executors_tell_how_busy_they_are_and_with_what(alone: Node, make: Any) -> None:
    executor: Executor = make(context=alone.context)
    executor.add_node(alone)
    ran: list[None] = []

    def on_timer() -> None:
        time.sleep(0.02)
        ran.append(None)

    alone.create_timer(0.001, on_timer, callback_group=ReentrantCallbackGroup())
    figures(alone)
    until = time.monotonic() + LIMIT
    while len(ran) < 3 and time.monotonic() < until:
        executor.spin_once(timeout_sec=1)
    (found,) = figures(alone)["executors"]
    executor.shutdown()
    assert found["kind"] == type(executor).__name__
    assert found["callbacks"] >= 2
    assert 20e6 <= found["longest"] <= found["busy"] < 2 * found["measured"]
    assert found["longest_is"].startswith("timer ")
    assert found["longest_is"].endswith("on_timer of /here/alone")


def test_a_callback_that_does_not_return_counts_while_it_runs(alone: Node) -> None:
    executor = SingleThreadedExecutor(context=alone.context)
    executor.add_node(alone)
    began, may_end = threading.Event(), threading.Event()

    def on_word(_: String) -> None:
        began.set()
        may_end.wait(LIMIT)

    alone.create_subscription(String, "word", on_word, 1)
    alone.create_publisher(String, "word", 1).publish(String())
    figures(alone)
    thread = threading.Thread(target=executor.spin_once, args=(LIMIT,))
    thread.start()
    assert began.wait(LIMIT)
    (found,) = figures(alone)["executors"]
    may_end.set()
    thread.join(LIMIT)
    executor.shutdown()
    assert (found["callbacks"], found["longest_is"]) == (0, "subscription /here/word of /here/alone")
    assert 0 < found["longest"] == found["busy"]


def test_tasks_and_what_they_raise_are_as_without_measuring(alone: Node) -> None:
    executor = SingleThreadedExecutor(context=alone.context)
    figures(alone)

    async def fail() -> None:
        raise LookupError("on purpose")

    executor.create_task(fail)
    with pytest.raises(LookupError, match="on purpose"):
        executor.spin_once(timeout_sec=1)
    (found,) = figures(alone)["executors"]
    executor.shutdown()
    assert found["callbacks"] == 1
    assert found["longest_is"].endswith("fail")


def test_answers_are_bounded(alone: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statistics, "_MOST", 2)
    for number in range(3):
        alone.create_subscription(String, f"word{number}", lambda _: None, 1)
    found = figures(alone)
    assert len(found["subscriptions"]) == 2
    assert found["omitted"] >= 1
    assert figures(alone)["executors"] == []  # the others are shut down, or gone


def test_many_questions_cost_what_few_do(alone: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statistics, "_FRESH", LIMIT)
    assert figures(alone)["clock"] == figures(alone)["clock"]


def test_the_arguments_of_a_program_are_its_own(alone: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["/home/somebody/walk.py", "--password=secret"])
    assert figures(alone)["program"] == "walk"
    monkeypatch.setattr("sys.argv", ["/opt/walker/__main__.py"])
    assert figures(alone)["program"] == "walker"
