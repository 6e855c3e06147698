"""`ifgen topic echo`: what was published before is kept for it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import PoseStamped
from ifgen.dynamic import class_from_text
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String

from tests.cli.conftest import Run

KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def node() -> Iterator[Node]:
    """A node that publishes three numbers on /speed, and a pose on /pose."""
    rclpy.init(args=[])
    node = rclpy.create_node("robot", enable_rosout=False)
    speed = node.create_publisher(Float64, "speed", KEPT)
    for value in (0.1, 1.5, -2.0):
        speed.publish(Float64(data=value))
    pose = PoseStamped()
    pose.header.frame_id = "map"
    pose.pose.position.x = 0.1
    node.create_publisher(PoseStamped, "pose", KEPT).publish(pose)
    yield node
    node.destroy_node()
    rclpy.shutdown()


def test_once(ifgen: Run, node: Node) -> None:
    done = ifgen("topic", "echo", "--once", "speed")
    assert (done.code, done.out, done.err) == (0, "data: 0.1\n---\n", "")


def test_until_the_time_is_over(ifgen: Run, node: Node) -> None:
    assert ifgen("topic", "echo", "/speed", "--timeout", "0.1", "--csv").out == "0.1\n1.5\n-2.0\n"


def test_filter_and_field(ifgen: Run, node: Node) -> None:
    assert ifgen("topic", "echo", "/speed", "--once", "--filter", "m.data > 1").out == "data: 1.5\n---\n"
    assert (
        ifgen("topic", "echo", "/speed", "--once", "--field", "data", "--filter", "m < 0").out
        == "-2.0\n---\n"
    )
    shown = ifgen("topic", "echo", "/pose", "--once", "--field", "pose.position").out
    assert shown == "x: 0.1\ny: 0.0\nz: 0.0\n---\n"


def test_other_forms(ifgen: Run, node: Node) -> None:
    assert ifgen("topic", "echo", "/speed", "--once", "--json").out == '{"data": 0.1}\n'
    raw = ifgen("topic", "echo", "/speed", "--once", "--raw").out
    assert raw == "b'\\x00\\x01\\x00\\x00\\x9a\\x99\\x99\\x99\\x99\\x99\\xb9?'\n---\n"
    with_info = ifgen("topic", "echo", "/speed", "--once", "--json", "-i").out
    assert json.loads(with_info)["info"]["publication_sequence_number"] == 1
    assert ifgen("topic", "echo", "/speed", "--once", "-i").out.startswith("publication_sequence_number: 1\n")
    assert ifgen("topic", "echo", "/speed", "--once", "-i", "--csv").out.endswith(",0.1\n")
    cut = ifgen("topic", "echo", "/pose", "--once", "-l", "2", "--field", "header").out
    assert cut == "stamp:\n  sec: 0\n  nanosec: 0\nframe_id: ma...\n---\n"


def test_a_type_that_nobody_installed(ifgen: Run, node: Node) -> None:
    """The node that publishes it, in another thread, describes it."""
    from threading import Thread

    from rclpy.executors import SingleThreadedExecutor

    cls = class_from_text("far_msgs/msg/Gait", "float64 stride 0.1\nuint8 leg")
    node.create_publisher(cls, "gait", KEPT).publish(cls(leg=3))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        assert ifgen("topic", "echo", "/gait", "--once").out == "stride: 0.1\nleg: 3\n---\n"
    finally:
        executor.shutdown()
        thread.join(5)


def test_qos_fits_all_publishers(ifgen: Run, node: Node) -> None:
    lossy = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_publisher(Float64, "speed", lossy)
    done = ifgen("topic", "echo", "/speed", "--timeout", "0.1")
    assert done.out == ""
    assert "not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back to" in done.err
    assert "not all, publishers are offering QoSDurabilityPolicy.TRANSIENT_LOCAL. Falling back to" in done.err


def test_qos_that_cannot_match_names_the_policy(ifgen: Run, node: Node) -> None:
    node.create_publisher(String, "word", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    done = ifgen("topic", "echo", "/word", "--timeout", "0.1", "--qos-reliability", "reliable")
    said = "the publisher offers reliability best_effort, the subscription asks for reliable"
    assert (done.code, done.err) == (0, f"warning: no message will come from /robot: {said}\n")


@pytest.mark.parametrize(
    ("words", "code", "expected"),
    [
        (["/sped"], 1, "error: there is no topic '/sped'\n  = help: did you mean '/speed'"),
        (
            ["/speed", "std_msgs/msg/String"],
            1,
            "error: the topic '/speed' has the type std_msgs/msg/Float64, not std_msgs/msg/String\n  = help: see",
        ),
        (["/speed", "--field", "data", "--field", "x"], 2, "error: --field can be given once, not 2 times"),
        (["/speed", "--field", "dat"], 1, "error: std_msgs/msg/Float64 has no field 'dat'\n"),
        (["/speed", "std_msgs/msg/Flot64"], 1, "error: there is no type 'std_msgs/msg/Flot64'\n"),
        (
            ["/speed", "Float64"],
            1,
            "error: 'Float64' names no type\n  = help: write it as package/msg/Name\n",
        ),
        (["/speed", "--filter", "m >"], 2, "error: --filter 'm >' is no Python expression: invalid syntax"),
        (["/speed", "--filter", "m.x"], 1, "error: --filter 'm.x' failed: AttributeError: "),
        (["/speed", "--raw", "--csv"], 2, "error: --csv and --raw exclude each other: leave out one\n"),
        (["/speed", "--raw", "--field", "data"], 2, "error: --raw shows bytes, which have no fields"),
        (["/speed", "--qos-depth", "-1"], 2, "error: invalid value for '--qos-depth'"),
    ],
)
def test_what_is_wrong_is_named(ifgen: Run, node: Node, words: list[str], code: int, expected: str) -> None:
    done = ifgen("topic", "echo", "--timeout", "5", *words)
    assert (done.code, done.out) == (code, "")
    assert done.err.startswith(expected)


def test_another_type_comes_later(ifgen: Run, node: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ifgen_tools.topic.topics._LOOK_EVERY", 0.01)
    threading.Timer(0.1, lambda: node.create_publisher(Float64, "late", 1)).start()
    done = ifgen("topic", "echo", "/late", "std_msgs/msg/String", "--timeout", "5")
    refusal = "error: the topic '/late' has the type std_msgs/msg/Float64, not std_msgs/msg/String\n"
    assert (done.code, done.err) == (1, f"{refusal}  = help: see `ifgen topic type /late`\n")


def test_two_types_on_a_topic(ifgen: Run, node: Node) -> None:
    other = rclpy.Context()
    rclpy.init(args=[], context=other)
    guest = rclpy.create_node("guest", context=other)
    guest.create_publisher(String, "speed", 1)
    done = ifgen("topic", "echo", "/speed")
    assert done.code == 1
    assert done.err.startswith("error: the topic '/speed' has more than one type: std_msgs/msg/")
    assert ifgen(
        "topic", "echo", "/speed", "std_msgs/Float64", "--once", "--qos-durability", "transient_local"
    ).out
    guest.destroy_node()
    rclpy.shutdown(context=other)


def test_a_list_that_is_shorter(ifgen: Run, node: Node) -> None:
    node.create_publisher(JointState, "joints", KEPT).publish(JointState(position=[0.1]))
    assert ifgen("topic", "echo", "/joints", "--once", "--field", "position[0]").out == "0.1\n---\n"
    done = ifgen("topic", "echo", "/joints", "--once", "--field", "position[1]")
    assert (done.code, done.err) == (
        1,
        "error: a message has come in which the list of --field is shorter\n",
    )


def test_an_expression_that_fails(ifgen: Run, node: Node) -> None:
    done = ifgen("topic", "echo", "/speed", "--once", "--filter", "m.speed > 1")
    assert (done.code, done.err) == (
        1,
        "error: --filter 'm.speed > 1' failed: AttributeError: 'Float64' object has no attribute 'speed'\n"
        "  = help: the message is called m\n",
    )
