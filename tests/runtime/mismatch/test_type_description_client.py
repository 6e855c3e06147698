"""The client of `~/get_type_description`: whom it asks, how long it waits, and whom it believes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime.convert import from_dict
from ifgen_runtime.field_types import type_name
from ifgen_runtime.mismatch.reporting import definition_of
from ifgen_runtime.mismatch.type_description_client import (
    Definitions,
    Question,
    definition_from,
    worth_asking,
)
from ifgen_runtime.type_description import describe
from type_description_interfaces.msg import TypeSource
from type_description_interfaces.srv import GetTypeDescription

Point, Speed = (
    class_from_text(name, text)
    for name, text in (("my_msgs/msg/Point", "float64 x"), ("my_msgs/msg/Speed", "float64 value"))
)


def asked(node: str, about: type[Any] = Point) -> Question:
    return Question(node, type_name(about), about.__type_hash__)


def response(about: type[Any]) -> Any:
    message = from_dict(type(GetTypeDescription.Response().type_description), describe(about))
    return SimpleNamespace(successful=True, type_description=message, type_sources=[])


@dataclass
class Nodes:
    """A connection in virtual time: when a node appears [s], when it answers, and what it says."""

    appearing: dict[str, float] = field(default_factory=dict[str, float])
    answering: dict[str, tuple[float, Any]] = field(default_factory=dict[str, tuple[float, Any]])
    time: float = 0.0
    sent: list[str] = field(default_factory=list[str])

    def now(self) -> float:
        return self.time

    def wait(self, seconds: float) -> None:
        self.time += min(seconds, 0.125)

    def send(self, question: Question, patience: float) -> Callable[[], Iterable[Any]] | None:
        if self.time < self.appearing.get(question.node, 0.0):
            return None
        self.sent.append(question.node)
        at, said = self.answering.get(question.node, (1000.0, None))
        return lambda: [said] if self.time >= at else []


def definitions(nodes: Nodes, is_over: Callable[[], bool] = lambda: False) -> Definitions:
    return Definitions(lambda: nullcontext(nodes), is_over)


def test_a_busy_node_that_is_there_has_three_seconds_to_answer() -> None:
    nodes = Nodes(answering={"/busy": (2.75, response(Point))})
    client = definitions(nodes)
    client.ask([asked("/busy")])
    found = client.get(asked("/busy"))
    assert found is not None and found.document == describe(Point)
    assert nodes.time == 2.75


def test_a_node_that_cannot_be_asked_costs_a_second_and_a_silent_one_three() -> None:
    absent, silent = Nodes(appearing={"/old": 1000.0}), Nodes()
    for nodes, node, seconds in ((absent, "/old", 1.0), (silent, "/silent", 3.0)):
        client = definitions(nodes)
        client.ask([asked(node)])
        assert (client.get(asked(node)), nodes.time) == (None, seconds)
        client.ask([asked(node)])  # once
        assert nodes.time == seconds


def test_three_nodes_are_asked_for_a_definition_and_one_answer_is_for_all() -> None:
    nodes = Nodes(answering={"/c": (0.25, response(Point)), "/speed": (0.5, response(Speed))})
    client = definitions(nodes)
    client.ask([*map(asked, ["/a", "/b", "/c", "/d"]), asked("/speed", Speed)])
    assert nodes.sent == ["/a", "/speed", "/b", "/c"]
    assert client.get(asked("/d")) is not None
    assert nodes.time == 0.5  # nobody waits for /a and /b


def test_a_definition_that_does_not_fit_its_hash_is_believed_of_its_node_only() -> None:
    nodes = Nodes(answering={"/liar": (0.25, response(Speed)), "/mute": (0.25, None)})
    client = definitions(nodes)
    client.ask([asked("/liar"), asked("/mute")])
    lie = client.get(asked("/liar"))
    assert lie is not None and lie.document == describe(Speed)
    assert client.get(asked("/mute")) is None
    client.ask([asked("/honest")])
    assert nodes.sent[-1] == "/honest"


def test_nothing_is_asked_or_waited_for_once_all_is_over() -> None:
    nodes = Nodes()
    definitions(nodes, lambda: True).ask([asked("/a")])
    assert nodes.sent == []
    definitions(nodes, lambda: nodes.time > 0).ask([asked("/a")])
    assert nodes.time == 0.125


def test_nobody_without_a_name_or_a_hash_is_asked() -> None:
    assert worth_asking([Question("", "a/msg/B", "RIHS01_1"), Question("/a", "a/msg/B", "")]) == []


def test_an_answer_has_the_definition_that_the_class_of_the_other_node_was_generated_from() -> None:
    text = "geometry_msgs/Point[<=3] path\nfloat64 speed 0.1  # [m/s]\n"
    own = definition_of(class_from_text("robot_msgs/msg/Plan", text))
    response = GetTypeDescription.Response(successful=True)
    response.type_description = from_dict(type(response.type_description), own.document)
    response.type_sources = [
        TypeSource(type_name=name, encoding=encoding, raw_file_contents=text)
        for name, encoding, text in own.sources
    ]
    found = definition_from(response)
    assert found == own
    assert found.sources[0] == ("robot_msgs/msg/Plan", "msg", text)


@pytest.mark.parametrize(
    ("reason", "said"), [("no such type", "no such type"), ("", "the node does not say why")]
)
def test_a_node_that_refuses_says_why(reason: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"^{said}$"):
        definition_from(SimpleNamespace(successful=False, failure_reason=reason))
