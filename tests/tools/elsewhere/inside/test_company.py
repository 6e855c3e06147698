"""Who has company is told nothing, unless what is wanted is not here."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from ifgen_runtime.domains import neighbours
from ifgen_runtime.domains.neighbours import Nodes

from tests.cli.conftest import Run

SENTENCE = "at least 5 nodes run on the real rclpy: --transport rclpy"


@pytest.fixture
def robots(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Two nodes of one name here, and five on the real rclpy."""
    rclpy.init(args=[])
    nodes = [rclpy.create_node("robot") for _ in range(2)]
    there = {nodes[0].context.get_domain_id(): Nodes(5, is_least=True)}
    monkeypatch.setattr(neighbours, "_is_off", lambda: False)
    monkeypatch.setattr(neighbours, "on_real_rclpy", lambda: there)
    monkeypatch.setattr(neighbours, "_everybody", {"rclpy": there, "local": {}}.__getitem__)
    yield
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown()


@pytest.mark.parametrize(
    "words", ["node list", "topic list", "service list", "node info /robot", "topic find a/msg/B"]
)
def test_nothing_is_said_of_others(words: str, robots: None, ifgen: Run) -> None:
    assert SENTENCE not in ifgen(*words.split(), "--transport", "local").err


@pytest.mark.parametrize(
    "words", ["node info /arm", "topic info /arm", "param get /arm x", "service type /arm/set"]
)
def test_what_is_not_here_may_be_there(words: str, robots: None, ifgen: Run) -> None:
    assert ifgen(*words.split(), "--transport", "local").err.count(SENTENCE) == 1


@pytest.mark.parametrize("words", ["node info /robot", "lifecycle get /robot"])
def test_a_doubled_name_is_said(words: str, robots: None, ifgen: Run) -> None:
    assert "warning: 2 nodes are called /robot" in ifgen(*words.split(), "--transport", "local").err
