"""`ifgen topic list`, `info`, `type` and `find`."""

from __future__ import annotations

import json

import pytest
from rclpy.node import Node

from tests.cli.conftest import Run


def test_names(ifgen: Run, talker: Node) -> None:
    assert ifgen("topic", "list").out == "/chatter\n/parameter_events\n/robot/speed\n"
    assert ifgen("topic", "list", "--count-topics").out == "3\n"
    hidden = ["/_secret", "/chatter", "/parameter_events", "/robot/speed"]
    assert ifgen("topic", "list", "--include-hidden-topics").out.split() == hidden


def test_types(ifgen: Run, talker: Node) -> None:
    lines = ifgen("topic", "list", "-t").out.splitlines()
    assert "/robot/speed [std_msgs/msg/Float64]" in lines


def test_counts(ifgen: Run, talker: Node) -> None:
    published, _, subscribed = ifgen("topic", "list", "-v").out.partition("\n\nSubscribed topics:\n")
    assert " * /chatter [std_msgs/msg/String] 2 publishers" in published.splitlines()
    assert subscribed == " * /robot/speed [std_msgs/msg/Float64] 1 subscriber\n\n"


def test_list_as_json(ifgen: Run, talker: Node) -> None:
    found = json.loads(ifgen("topic", "list", "--json").out)
    assert {"name": "/chatter", "types": ["std_msgs/msg/String"], "publishers": 2, "subscribers": 0} in found


def test_type_and_find(ifgen: Run, talker: Node) -> None:
    assert ifgen("topic", "type", "chatter").out == "std_msgs/msg/String\n"
    assert ifgen("topic", "type", "/chatter", "--json").out == '["std_msgs/msg/String"]\n'
    assert ifgen("topic", "find", "std_msgs/msg/String").out == "/chatter\n"
    assert ifgen("topic", "find", "std_msgs/msg/String", "--include-hidden-topics", "-c").out == "2\n"
    assert ifgen("topic", "find", "std_msgs/msg/Bool", "--json").out == "[]\n"


def test_info(ifgen: Run, talker: Node) -> None:
    short = "Type: std_msgs/msg/Float64\nPublisher count: 0\nSubscription count: 1\n"
    assert ifgen("topic", "info", "/robot/speed").out == short
    paragraphs = ifgen("topic", "info", "-v", "/robot/speed").out.split("\n\n")
    assert paragraphs[:3] == ["Type: std_msgs/msg/Float64", "Publisher count: 0", "Subscription count: 1"]
    assert paragraphs[3].startswith(
        "Node name: talker\nNode namespace: /\nTopic type: std_msgs/msg/Float64\n"
    )
    assert "  Reliability: RELIABLE\n" in paragraphs[3]


def test_info_as_json(ifgen: Run, talker: Node) -> None:
    found = json.loads(ifgen("topic", "info", "/robot/speed", "--json").out)
    [subscription] = found["subscriptions"]
    assert (found["types"], found["publishers"]) == (["std_msgs/msg/Float64"], [])
    assert subscription["node"] == "/talker"
    assert subscription["qos"]["reliability"] == "reliable"


@pytest.mark.parametrize("verb", ["info", "type"])
def test_an_unknown_topic_names_near_ones(ifgen: Run, talker: Node, verb: str) -> None:
    done = ifgen("topic", verb, "/chater")
    assert (done.code, done.err) == (
        1,
        "error: there is no topic '/chater'\n  = help: did you mean '/chatter'?\n",
    )


def test_what_can_be_no_topic(ifgen: Run, talker: Node) -> None:
    done = ifgen("topic", "type", "/a//b")
    assert done.code == 1
    assert done.err.startswith("error: '/a//b' can be no topic: ")
    assert done.err.endswith("  = help: write it such as /robot/odometry\n")
