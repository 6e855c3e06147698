"""`ifgen topic hz`, `bw` and `delay`: figures of times that are given, and what is printed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

import pytest
import rclpy
from geometry_msgs.msg import PointStamped
from ifgen_tools.session import Session
from ifgen_tools.topic import rates
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64

from tests.cli.conftest import Run

MS = 1_000_000  # [ns]
KEPT = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Enough(Exception):
    """Ends a verb that goes on for ever."""


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Iterator[Node]:
    """A node that has published 31 numbers and stamped points; each is heard 100 ms after the one before."""
    rclpy.init(args=[])
    node = rclpy.create_node("robot", enable_rosout=False)
    speed = node.create_publisher(Float64, "speed", KEPT)
    point = node.create_publisher(PointStamped, "point", KEPT)
    for count in range(31):
        speed.publish(Float64(data=float(count)))
        stamped = PointStamped()
        stamped.header.stamp.sec = 1
        stamped.header.stamp.nanosec = 100 * MS * (count % 10)
        point.publish(stamped)
    moments = iter(range(2_000 * MS, 100_000 * MS, 100 * MS))
    monkeypatch.setattr(Session, "now", lambda _: next(moments))
    yield node
    node.destroy_node()
    rclpy.shutdown()


@pytest.fixture
def ends(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Let a verb end with its n-th text."""

    def after(count: int) -> None:
        said: list[str] = []

        def say(text: str, **_: object) -> None:
            said.append(text)
            print(text)
            if len(said) == count:
                raise KeyboardInterrupt

        monkeypatch.setattr(rates, "print", say, raising=False)

    return after


def test_rate(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(2)
    done = ifgen("topic", "hz", "/speed")
    assert done.code == 2
    deltas = "\tmin: 0.100s max: 0.100s std dev: 0.00000s window: "
    assert done.out == f"average rate: 10.000\n{deltas}10\naverage rate: 10.000\n{deltas}20\n"


def test_rate_of_some_messages_of_several_topics(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(1)
    done = ifgen(
        "topic", "hz", "/speed", "point", "--filter", "hasattr(m, 'data') and m.data % 2 == 0", "-w", "4"
    )
    assert done.out.startswith("/speed: average rate: ")
    assert done.out.endswith("window: 4\n")


def test_rate_as_json(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(1)
    found = json.loads(ifgen("topic", "hz", "/speed", "--json").out)
    assert found == {"topic": "/speed", "rate": 10.0, "min": 0.1, "max": 0.1, "std_dev": 0.0, "window": 10}


def test_time_that_begins_anew(
    ifgen: Run, node: Node, ends: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = iter([5 * MS, 6 * MS, 1 * MS, *range(2 * MS, 10_000 * MS, 500 * MS)])
    monkeypatch.setattr(Session, "now", lambda _: next(moments))
    ends(2)
    lines = ifgen("topic", "hz", "/speed").out.splitlines()
    assert lines[0] == "time has reset, resetting counters"
    assert lines[2].endswith("window: 3")


def test_bandwidth(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(2)
    done = ifgen("topic", "bw", "/speed")
    size = "12 B"  # four for the encapsulation
    assert done.out.splitlines()[0] == "Subscribed to [/speed]"
    assert done.out.endswith(f" from 31 messages\n\tMessage size mean: {size} min: {size} max: {size}\n")


def test_delay(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(1)
    found = json.loads(ifgen("topic", "delay", "/point", "-w", "10", "--json").out)
    assert found["window"] == 10
    assert found["min"] == pytest.approx(3.0)
    assert found["max"] == pytest.approx(4.0)


def test_delay_needs_a_header(ifgen: Run, node: Node) -> None:
    done = ifgen("topic", "delay", "/speed")
    assert done.err == "error: std_msgs/msg/Float64 has no header, so '/speed' has no times to compare with\n"


def test_the_bandwidth_of_even_messages() -> None:
    """Ten messages of 100 B, one every 0.1 s, are 1 kB/s: the first begins the time."""
    assert rates._bandwidth_text("/a", [100] * 11, 1.0, False).startswith("1.00 KB/s from 11 messages")


@pytest.mark.slow
def test_bandwidth_when_time_begins_anew(
    ifgen: Run, node: Node, ends: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = iter([*[5_000 * MS] * 31, 1 * MS])
    monkeypatch.setattr(Session, "now", lambda _: next(moments))
    ends(2)
    done = ifgen("topic", "bw", "/speed")
    assert (done.code, done.out) == (2, "Subscribed to [/speed]\nWARNING: time is reset!\n")


@pytest.mark.slow
def test_delay_without_new_messages(ifgen: Run, node: Node, ends: Callable[[int], None]) -> None:
    ends(2)
    lines = ifgen("topic", "delay", "/point").out.splitlines()
    assert lines[0].startswith("average delay: ")
    assert lines[-1] == "no new messages"
