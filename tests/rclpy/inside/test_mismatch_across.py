"""Definitions that differ between processes: the other side is asked for its own, once and not for long.

As in contract/processes.py, domains of this process stand for processes.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime import from_dict
from ifgen_runtime.mismatch import reporting, type_description_client
from ifgen_runtime.mismatch.reporting import Mismatch, definition_of, explanation
from ifgen_runtime.mismatch.type_description_client import Patience
from ifgen_runtime.type_description import describe
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import Float64
from type_description_interfaces.msg import TypeDescription
from type_description_interfaces.srv import GetTypeDescription

from tests.rclpy.inside.contract.processes import Pair

POINT, ADD, WALK = "demo_msgs/msg/Point", "demo_msgs/srv/Add", "demo_msgs/action/Walk"
OldPoint = class_from_text(POINT, "float32 x")
NewPoint = class_from_text(POINT, "float32 x\nfloat32 depth")
OldAdd = class_from_text(ADD, "float32 a\n---\nfloat32 sum")
NewAdd = class_from_text(ADD, "float32 a\n---\nfloat32 sum\nstring note")
OldWalk = class_from_text(WALK, "float32 goal\n---\nfloat32 reached\n---\nfloat32 left")
NewWalk = class_from_text(
    WALK, "float32 goal\nstring gait\n---\nfloat32 reached\n---\nfloat32 left\nuint8 step"
)
ASKED = "/get_type_description"


pytestmark = [pytest.mark.usefixtures("no_adapters", "heard"), pytest.mark.slow]


@pytest.fixture
def pair(across: Pair) -> Pair:
    return across


def told(heard: list[Mismatch], role: str) -> list[Mismatch]:
    """What the side with this role has said."""
    return [mismatch for mismatch in heard if mismatch.mine.role == role]


def asks(pair: Pair) -> int:
    return sum(what == "ask" and name.endswith(ASKED) for _, what, name in pair.network.log)


def ignore(_: Any) -> None:
    """A callback that is never called, or whose messages do not matter."""


@pytest.mark.parametrize("publisher_first", [True, False])
def test_both_sides_explain_which_field_differs(
    pair: Pair, heard: list[Mismatch], publisher_first: bool
) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    ends: list[Callable[[], Any]] = [
        lambda: one.create_publisher(OldPoint, "point", 10),
        lambda: other.create_subscription(NewPoint, "point", ignore, 10),
    ]
    for end in ends if publisher_first else ends[::-1]:
        end()
    pair.until(lambda: len(heard) == 2)
    (at_reader,) = told(heard, "subscription")
    (at_writer,) = told(heard, "publisher")
    assert at_reader.theirs.definition == definition_of(OldPoint)
    assert at_writer.theirs.definition == definition_of(NewPoint)
    text = explanation(at_reader)
    assert "[field-added]" in text
    assert "depth" in text
    pair.settle()
    assert len(heard) == 2


def test_nobody_sees_who_asks(pair: Pair, heard: list[Mismatch]) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    seen: set[str] = set()
    one.create_publisher(OldPoint, "point", 10)
    other.create_subscription(NewPoint, "point", ignore, 10)

    def look() -> bool:
        seen.update(one.get_node_names())
        assert one.count_clients(f"/one{ASKED}") == one.count_clients(f"/two{ASKED}") == 0
        return len(heard) == 2

    pair.until(look)
    assert seen <= {"one", "two"}


def test_services_are_explained(pair: Pair, heard: list[Mismatch]) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    one.create_client(OldAdd, "add")
    other.create_service(NewAdd, "add", lambda _, response: response)
    pair.until(lambda: len(heard) == 2)
    (at_server,) = told(heard, "service server")
    assert at_server.kind == "service"
    assert at_server.theirs.definition == definition_of(OldAdd)
    text = explanation(at_server)
    assert "[field-added]" in text
    assert "note" in text


def test_an_action_is_one_warning_about_its_first_part_that_differs(
    pair: Pair, heard: list[Mismatch]
) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    client = ActionClient(one, OldWalk, "walk")
    server = ActionServer(other, NewWalk, "walk", lambda handle: NewWalk.Result())
    pair.until(lambda: len(heard) == 2)
    pair.settle()
    assert sorted(mismatch.mine.role for mismatch in heard) == ["action client", "action server"]
    (at_server,) = told(heard, "action server")
    assert (at_server.kind, at_server.name) == ("action", "/walk")
    assert at_server.theirs.definition is not None
    text = explanation(at_server)
    assert "[field-added]" in text, text
    assert "gait" in text or "step" in text
    client.destroy()
    server.destroy()


def test_nodes_answer_for_parts_of_services_and_actions(recorded: Pair) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    server = ActionServer(other, NewWalk, "walk", lambda handle: NewWalk.Result())
    other.create_service(NewAdd, "add", lambda _, response: response)
    client = one.create_client(GetTypeDescription, f"/two{ASKED}")
    recorded.until(client.service_is_ready)
    for cls in (
        NewAdd,
        NewAdd.Request,
        NewAdd.Response,
        NewWalk,
        NewWalk.Goal,
        NewWalk.Impl.SendGoalService.Request,
    ):
        future = client.call_async(GetTypeDescription.Request(type_hash=cls.__type_hash__))
        recorded.until(future.done)
        assert future.result().successful, cls
        assert future.result().type_description.type_description.type_name.endswith(cls.__name__)
    server.destroy()


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait for silent nodes half a second, not three."""
    monkeypatch.setattr(type_description_client, "OF_WARNINGS", Patience(to_appear=0.5, to_answer=0.5))


def test_a_silent_peer_costs_only_the_detail_and_is_asked_once(
    recorded: Pair, heard: list[Mismatch], impatient: None
) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    other.create_subscription(NewPoint, "point", ignore, 10)
    before = time.monotonic()
    for number in range(3):
        one.create_publisher(OldPoint, "point", 10)
        _wait(lambda: len(told(heard, "subscription")) > number)  # noqa: B023 -- nobody spins meanwhile
    assert time.monotonic() - before < 2 * 0.5 + 1.0
    _wait(lambda: len(heard) == 6)
    assert [mismatch.theirs.definition for mismatch in heard] == [None] * 6
    assert asks(recorded) == 2
    assert "what differs is unknown" in explanation(heard[0])


def test_a_lie_is_noticed_and_believed_of_nobody_else(recorded: Pair, heard: list[Mismatch]) -> None:
    one, other, third = (recorded.process(name).node for name in ("one", "two", "three"))
    other.create_subscription(NewPoint, "point", ignore, 10)
    _lie(one, Float64)
    one.create_publisher(OldPoint, "point", 10)
    recorded.until(lambda: told(heard, "subscription"))
    (about_liar,) = told(heard, "subscription")
    assert "/one says what does not fit its hash" in " ".join(explanation(about_liar).split())
    third.create_publisher(OldPoint, "point", 10)
    recorded.until(lambda: len(told(heard, "subscription")) == 2)
    assert told(heard, "subscription")[1].theirs.definition == definition_of(OldPoint)


def test_a_peer_that_dies_while_it_is_asked_costs_only_the_detail(
    recorded: Pair, heard: list[Mismatch]
) -> None:
    one, other = recorded.process("one"), recorded.process("two").node
    other.create_subscription(NewPoint, "point", ignore, 10)
    one.node.create_publisher(OldPoint, "point", 10)
    _wait(lambda: asks(recorded) == 2)
    recorded.network.cut("one", "two")
    _wait(lambda: told(heard, "subscription"))
    assert told(heard, "subscription")[0].theirs.definition is None


def test_fifty_nodes_are_asked_a_few_times(recorded: Pair, heard: list[Mismatch]) -> None:
    publishing, listening = recorded.process("one"), recorded.process("two")
    nodes = [Node(f"node_{number}", context=publishing.node.context) for number in range(50)]
    for node in nodes:
        publishing.executor.add_node(node)
        node.create_publisher(OldPoint, "point", 10)
    listening.node.create_subscription(NewPoint, "point", ignore, 10)
    recorded.until(lambda: len(heard) == 100)
    assert all(
        mismatch.theirs.definition == definition_of(OldPoint) for mismatch in told(heard, "subscription")
    )
    assert asks(recorded) <= 3 + 1
    for node in nodes:
        node.destroy_node()


def test_nothing_is_said_when_the_context_has_ended(
    recorded: Pair, heard: list[Mismatch], impatient: None
) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    other.create_subscription(NewPoint, "point", ignore, 10)
    one.create_publisher(OldPoint, "point", 10)
    other.context.shutdown()
    _wait(lambda: told(heard, "publisher"))
    assert not told(heard, "subscription")


def test_a_listener_that_fails_does_not_end_the_warnings(
    recorded: Pair, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    topics: list[str] = []

    def fail(mismatch: Mismatch) -> None:
        topics.append(mismatch.name)
        raise RuntimeError("no")

    monkeypatch.setattr(reporting, "listener", fail)
    for topic in "abc":  # some of which are told together
        other.create_subscription(NewPoint, topic, ignore, 10)
        one.create_publisher(OldPoint, topic, 10)
    recorded.until(lambda: sorted(topics) == ["/a", "/a", "/b", "/b", "/c", "/c"])
    assert "failed with RuntimeError('no')" in capfd.readouterr().err


def test_the_thread_ends_with_its_work(recorded: Pair, heard: list[Mismatch]) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    before = threading.active_count()
    other.create_subscription(NewPoint, "point", ignore, 10)
    one.create_publisher(OldPoint, "point", 10)
    recorded.until(lambda: len(heard) == 2)
    assert threading.active_count() == before
    reporters = [process.link._reporter for process in recorded.processes]
    recorded.until(lambda: not any(reporter._is_reporting for reporter in reporters))


def _wait(condition: Callable[[], Any]) -> None:
    """Wait while nobody spins, as a process that is stopped does not."""
    end = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.001)


def _lie(node: Node, cls: type[Any]) -> None:
    """Let a node answer with the definition of another type, whatever it is asked for."""
    node._type_description_service.destroy()

    def answer(_: Any, response: Any) -> Any:
        response.successful = True
        response.type_description = from_dict(TypeDescription, describe(cls))
        return response

    node.create_service(GetTypeDescription, f"~{ASKED}", answer)
