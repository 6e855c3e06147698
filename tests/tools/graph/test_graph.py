"""The connections of endpoints, and the three renderings of them."""

from __future__ import annotations

import math
import shutil
import subprocess
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.nodl.model import Category, QosProfile, qos_mismatch
from ifgen_tools.graph.connections import Graph, of_endpoints
from ifgen_tools.graph.layout import layout
from ifgen_tools.graph.svg import dot, mermaid, svg
from ifgen_tools.ros_graph import Endpoint

BEST_EFFORT = QosProfile("KEEP_LAST", "BEST_EFFORT", depth=1)
RELIABLE = QosProfile("KEEP_LAST", "RELIABLE", depth=1)
LATCHED = QosProfile("KEEP_LAST", "RELIABLE", depth=1, durability="TRANSIENT_LOCAL")


def seen(
    node: str, name: str, category: Category, qos: QosProfile | None = None, type_name: str = "a_msgs/msg/A"
) -> Endpoint:
    return Endpoint(node, name, category, type_name, qos)


@pytest.fixture
def graph() -> Graph:
    return of_endpoints(
        ["/talker", "/listener"],
        [
            seen("/talker", "/fast", Category.PUBLISHER, BEST_EFFORT),
            seen("/listener", "/fast", Category.SUBSCRIPTION, RELIABLE),
            seen("/talker", "/fine", Category.PUBLISHER, LATCHED),
            seen("/listener", "/fine", Category.SUBSCRIPTION, BEST_EFFORT),
            seen("/talker", "/alone", Category.PUBLISHER, RELIABLE),
            seen("/listener", "/ask", Category.SERVICE_SERVER),
        ],
    )


def test_ends_that_never_meet_are_marked_with_the_reason(graph: Graph) -> None:
    assert graph.problems == (
        "/fast: /talker and /listener never meet: BEST_EFFORT is offered, RELIABLE requested",
    )
    marked = {c.name for c in graph.connections if any(end.problem for end in (*c.sources, *c.targets))}
    assert marked == {"/fast"}


def test_empty_sides_are_told(graph: Graph) -> None:
    missing = {connection.name: connection.missing for connection in graph.connections}
    assert missing == {"/fast": None, "/fine": None, "/alone": "no subscription", "/ask": "no client"}


def test_two_types_on_one_topic_never_meet() -> None:
    graph = of_endpoints(
        ["/a", "/b"],
        [
            seen("/a", "/t", Category.PUBLISHER, RELIABLE),
            seen("/b", "/t", Category.SUBSCRIPTION, RELIABLE, "b_msgs/msg/B"),
        ],
    )
    assert "one has a_msgs/msg/A, the other b_msgs/msg/B" in graph.problems[0]


def profile(**values: object) -> QosProfile:
    return QosProfile(**{"history": "KEEP_LAST", "reliability": "RELIABLE", "depth": 1} | values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("offered", "requested", "meets"),
    [
        ({}, {}, True),
        ({"reliability": "BEST_AVAILABLE"}, {}, True),
        ({"durability": "VOLATILE"}, {"durability": "TRANSIENT_LOCAL"}, False),
        ({}, {"durability": "TRANSIENT_LOCAL"}, False),
        ({"durability": "TRANSIENT_LOCAL"}, {"durability": "VOLATILE"}, True),
        ({"durability": "SYSTEM_DEFAULT"}, {"durability": "TRANSIENT_LOCAL"}, True),
        ({"deadline_ns": 20}, {"deadline_ns": 10}, False),
        ({"deadline_ns": 10}, {"deadline_ns": 10}, True),
        ({"deadline_ns": 10}, {}, True),
        ({}, {"deadline_ns": 10}, False),
        ({"liveliness": "AUTOMATIC"}, {"liveliness": "MANUAL_BY_TOPIC"}, False),
        ({"liveliness": "MANUAL_BY_TOPIC"}, {"liveliness": "AUTOMATIC"}, True),
        ({"liveliness_lease_duration_ns": 20}, {"liveliness_lease_duration_ns": 10}, False),
        ({"lifespan_ns": 20}, {}, True),
    ],
)
def test_compatibility(offered: dict[str, object], requested: dict[str, object], meets: bool) -> None:
    assert (qos_mismatch(profile(**offered), profile(**requested)) is None) == meets


def test_renderings_hold_every_box_edge_and_problem(graph: Graph) -> None:
    picture = ElementTree.fromstring(svg(graph))
    space = {"s": "http://www.w3.org/2000/svg"}
    texts = [element.text for element in picture.iterfind(".//s:text", space)]
    for text in ("/talker", "/listener", "/fast", "/alone", "no subscription", *graph.problems):
        assert text in texts
        assert text in dot(graph)
        assert text in mermaid(graph)
    classes = [element.get("class") for element in picture.iterfind("s:path", space)]
    assert sorted(filter(None, classes)) == ["never", "never", "open", "open"]
    assert mermaid(graph).count("-->") == 4
    assert mermaid(graph).count("-.->") == 2
    assert dot(graph).count("color=red") == 2


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
def test_graphviz_reads_the_dot(graph: Graph) -> None:
    done = subprocess.run(
        ["dot", "-Tplain"], input=dot(graph), capture_output=True, text=True, timeout=30, check=True
    )
    assert done.stdout.count("\nedge ") == 6


def test_nothing_is_a_picture_too() -> None:
    ElementTree.fromstring(svg(Graph((), ())))


boxes = st.integers(1, 12)


@settings(max_examples=60)
@given(count=boxes, pairs=st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=30))
def test_boxes_never_overlap_and_every_edge_has_its_way(count: int, pairs: list[tuple[int, int]]) -> None:
    names = [f"b{index}" for index in range(count)]
    sizes = {name: (40.0 + 7 * index, 20.0 + index) for index, name in enumerate(names)}
    edges = [(f"b{a}", f"b{b}") for a, b in pairs if a != b and a < count and b < count]
    placed = layout(sizes, edges)
    assert set(placed.bends) == set(edges)
    for index, one in enumerate(names):
        for other in names[:index]:
            (x1, y1), (x2, y2) = placed.centres[one], placed.centres[other]
            apart_x = abs(x1 - x2) >= (sizes[one][0] + sizes[other][0]) / 2 - 1e-6
            apart_y = abs(y1 - y2) >= (sizes[one][1] + sizes[other][1]) / 2 - 1e-6
            assert apart_x or apart_y
    assert all(math.isfinite(value) for centre in placed.centres.values() for value in centre)
    assert placed == layout(sizes, edges)
