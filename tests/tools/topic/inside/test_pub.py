"""`ifgen topic pub`."""

from __future__ import annotations

import io
from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Header, String

from tests.cli.conftest import Run

QUICK = ("--keep-alive", "0.001")


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init(args=[])
    node = rclpy.create_node("robot", enable_rosout=False)
    yield node
    node.destroy_node()
    rclpy.shutdown()


def heard(node: Node, cls: type, topic: str) -> list[object]:
    """The messages that come to a topic; spin the node to have them."""
    messages: list[object] = []
    node.create_subscription(cls, topic, messages.append, 10)
    return messages


def test_once(ifgen: Run, node: Node) -> None:
    messages = heard(node, Twist, "cmd_vel")
    done = ifgen("topic", "pub", "-1", "cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.1}}", *QUICK)
    rclpy.spin_once(node, timeout_sec=5)
    assert messages[0].linear.x == 0.1  # type: ignore[attr-defined]
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("publisher: beginning loop\npublishing #1: geometry_msgs.msg.Twist(linear=")
    assert done.out.endswith(")\n\n")


def test_some_times(ifgen: Run, node: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    messages = heard(node, Header, "stamps")
    monkeypatch.setattr("sys.stdin", io.StringIO("stamp: now\nframe_id: map"))
    done = ifgen(
        "topic", "pub", "/stamps", "std_msgs/msg/Header", "--stdin", "-t", "4", "-r", "500", "-p", "2", *QUICK
    )
    assert done.out.count("publishing #") == 2
    for _ in range(4):
        rclpy.spin_once(node, timeout_sec=5)
    stamps = [message.stamp.sec * 10**9 + message.stamp.nanosec for message in messages]  # type: ignore[attr-defined]
    assert len(stamps) == 4
    assert stamps == sorted(set(stamps))


def test_the_name_of_the_node(ifgen: Run, node: Node) -> None:
    """What was published first stays for those who come later, as long as the node does."""
    messages = heard(node, String, "word")
    ifgen(
        "topic", "pub", "-1", "/word", "std_msgs/String", "data: a", "-n", "me", "-w", "0", "-p", "0", *QUICK
    )
    rclpy.spin_once(node, timeout_sec=5)
    assert messages == [String(data="a")]


def test_nobody_comes(ifgen: Run, node: Node) -> None:
    done = ifgen("topic", "pub", "-1", "/word", "std_msgs/String", "--max-wait-time-secs", "0.05")
    assert (done.code, done.out) == (1, "Waiting for at least 1 matching subscription(s)...\n")
    assert done.err.startswith(
        "error: 0 of 1 subscriptions have come within 0.05 s\n  = help: see `ifgen topic"
    )


def test_qos_that_cannot_match_names_the_policy(ifgen: Run, node: Node) -> None:
    node.create_subscription(
        String, "word", print, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    )
    words = ("/word", "std_msgs/String", "--qos-reliability", "best_effort", "--max-wait-time-secs", "0.2")
    done = ifgen("topic", "pub", "-1", *words)
    reliability = "the publisher offers reliability best_effort, the subscription asks for reliable"
    durability = "the publisher offers durability volatile, the subscription asks for transient_local"
    assert done.err.startswith(f"warning: no message will go to /robot: {reliability}; {durability}\n")


def test_another_type_is_said(ifgen: Run, node: Node) -> None:
    node.create_subscription(
        String, "word", print, QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
    )
    done = ifgen("topic", "pub", "-1", "/word", "std_msgs/Bool", "-w", "0", *QUICK)
    assert done.err == "warning: /word has the type std_msgs/msg/String too\n"


@pytest.mark.parametrize(
    ("words", "code", "expected"),
    [
        (["std_msgs/Strin"], 1, "error: there is no type 'std_msgs/msg/Strin'\n  = help: did you mean "),
        (
            ["std_msg/String"],
            1,
            "error: there is no interface package 'std_msg'\n  = help: did you mean 'std_msgs/msg/String'? If not, "
            "run this in the project that has it\n",
        ),
        (["std_msgs/String", "{dat: a}"], 1, "error: std_msgs/msg/String has no field 'dat'\n"),
        (
            ["std_msgs/String", "a"],
            1,
            'error: the message: expected the fields of std_msgs/msg/String, got "a"\n',
        ),
        (["std_msgs/String", "{data: [}"], 1, "error: the values are no YAML: "),
        (["std_msgs/String", "-t", "2"], 2, "error: --once and --times exclude each other: leave out one\n"),
        (["std_msgs/String", "{}", "--stdin"], 2, "error: --stdin reads the values: leave out VALUES\n"),
        (
            ["std_msgs/String", "-w", "0", "--max-wait-time-secs", "1"],
            2,
            "error: --max-wait-time-secs needs ",
        ),
        (
            ["std_msgs/String", "-r", "0"],
            2,
            "error: invalid value for '-r' / '--rate': 0.0 is not in the range",
        ),
    ],
)
def test_what_is_wrong_is_named(ifgen: Run, node: Node, words: list[str], code: int, expected: str) -> None:
    done = ifgen("topic", "pub", "--once", "/word", *words)
    assert (done.code, done.out) == (code, "")
    assert done.err.startswith(expected)
