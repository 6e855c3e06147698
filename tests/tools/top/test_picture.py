"""Where boxes are, and messages as trees."""

from __future__ import annotations

import json
import math
from array import array
from dataclasses import replace
from typing import Any, ClassVar

from ifgen_tools.top.snapshot import ServiceRow, TopicRow
from ifgen_tools.top.web.page import distances, pictures, structure, tree

from tests.tools.top.samples import ROBOT


def ids(picture: dict[str, Any]) -> set[str]:
    return {box["id"] for box in picture["boxes"]}


def test_services_and_topics_with_one_side_are_drawn_on_request() -> None:
    found = pictures(structure(ROBOT))
    joints = "topic /arm/very_long_name_of_a_topic/joint_states"
    nodes = {"node /camera", "node /arm/controller", "node /elsewhere"}
    leaves, services = {"topic /camera/image_raw", "topic /quiet"}, {"service /arm/reset"}
    assert ids(found["00"]) == nodes | {joints}
    assert ids(found["01"]) == nodes | {joints} | leaves
    assert ids(found["10"]) == nodes | {joints} | services
    assert ids(found["11"]) == nodes | {joints} | leaves | services
    lines = [(line["from"], line["to"]) for line in found["00"]["lines"]]
    assert lines == [("node /camera", joints), ("node /elsewhere", joints), (joints, "node /arm/controller")]


def test_what_every_node_has_is_not_drawn() -> None:
    parameters = ServiceRow("/camera/get_parameters", ("rcl_interfaces/srv/GetParameters",), ("/camera",), ())
    log = TopicRow("/rosout", (), ("/camera",), ("/arm/controller",))
    robot = replace(ROBOT, topics=(log,), services=(parameters,))
    assert ids(pictures(structure(robot))["11"]) == {f"node {each.name}" for each in ROBOT.nodes}
    asked = replace(parameters, clients=("/elsewhere",))
    assert "service /camera/get_parameters" in ids(
        pictures(structure(replace(robot, services=(asked,))))["11"]
    )


def test_what_everybody_has_is_a_box_without_lines() -> None:
    clock = TopicRow("/clock", (), ("/camera",), tuple(f"/node_{number}" for number in range(20)))
    picture = pictures(structure(replace(ROBOT, topics=(clock,))))["00"]
    assert "topic /clock" in ids(picture)
    assert picture["lines"] == []


def test_lines_join_neighbouring_columns() -> None:
    edges = [("node a", "topic x"), ("topic x", "node b"), ("node b", "topic y"), ("topic y", "node a")]
    found = distances(["node a", "node b", "topic x", "topic y", "node alone"], edges)
    assert found == {"node a": 0, "topic x": 1, "topic y": 1, "node b": 2, "node alone": 0}
    assert all(abs(found[one] - found[other]) == 1 for one, other in edges)


def test_boxes_do_not_overlap() -> None:
    boxes = pictures(structure(ROBOT))["11"]["boxes"]
    for index, one in enumerate(boxes):
        for other in boxes[index + 1 :]:
            apart = abs(one["x"] - other["x"]) >= (one["width"] + other["width"]) / 2
            assert apart or abs(one["y"] - other["y"]) >= one["height"]


class Message:
    """Like a generated one."""

    fields: ClassVar[dict[str, Any]] = {}

    def __init__(self, **values: Any) -> None:
        self.__dict__.update(values)

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, Any]:
        return cls.fields


def message(**values: Any) -> Message:
    return type("Made", (Message,), {"fields": dict.fromkeys(values)})(**values)


def test_a_tree_is_json_whatever_is_in_the_message() -> None:
    found = tree(
        message(
            inner=message(x=0.1, ok=True),
            bad=[math.nan, math.inf],
            large=2**60,
            raw=b"\x01\x02",
            numbers=array("d", [0.1, 1.5]),
            texts=["a", "b" * 2000],
        )
    )
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["inner"] == {"x": 0.1, "ok": True}
    assert found["bad"] == ["nan", "inf"]
    assert (found["large"], found["raw"], found["numbers"]) == (str(2**60), [1, 2], [0.1, 1.5])
    assert len(found["texts"][1]) == 1003


def test_large_messages_are_cut() -> None:
    found = tree(message(data=bytes(10**6), rows=[message(cells=list(range(100))) for _ in range(100)]))
    assert found["data"][-1] == {"more": 10**6 - 64}
    assert len(json.dumps(found)) < 50_000
