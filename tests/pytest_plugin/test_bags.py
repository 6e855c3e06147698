"""The fixtures `bag`, `record` and `replay`, as tests of a project use them."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest
from ifgen_pytest.recording import Recording
from ifgen_runtime.bag import Bag, OfferedQoS
from std_msgs.msg import Float64

from .support import needs_rclpy

# pytester forgets what is imported while it runs, and PyYAML's parser in C cannot be imported twice: reading a bag
# after that found no QoS.
importlib.import_module("yaml")

pytest_plugins = ("pytester",)

NODES = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64, String


class Wheel(Node):
    def __init__(self):
        super().__init__("wheel")
        self.publisher = self.create_publisher(Float64, "speed", 10)
        self.publisher.publish(Float64(data=-0.1))  # nobody has subscribed yet
        self.create_timer(0.1, self.turn)
        self.count = 0

    def turn(self):
        self.count += 1
        self.publisher.publish(Float64(data=0.1 * self.count))


class Brake(Node):
    gain = 2.0

    def __init__(self):
        super().__init__("brake")
        self.publisher = self.create_publisher(Twist, "cmd", 10)
        self.texts = self.create_publisher(String, "texts", 10)
        self.create_subscription(Float64, "speed", self.on_speed, 10)
        self.create_timer(0.25, self.on_time)

    def on_speed(self, message):
        command = Twist()
        command.linear.x = self.gain * message.data
        self.publisher.publish(command)

    def on_time(self):
        self.texts.publish(String(data=str(self.get_clock().now().nanoseconds)))
"""

RECORDING = """
from nodes import Brake, Wheel


def drive(ros_node, ros_collect):
    commands = ros_collect(__import__("geometry_msgs.msg").msg.Twist, "cmd")
    ros_node(Brake)
    ros_node(Wheel)
    return commands.wait(6, timeout=20)


def test_saved(record, ros_node, ros_collect):
    drive(ros_node, ros_collect)
    record.save("drive.mcap")


def test_passes(record, ros_node, ros_collect):
    assert len(drive(ros_node, ros_collect)) >= 6


def test_fails(record, ros_node, ros_collect):
    assert drive(ros_node, ros_collect)[5].linear.x < 0


def test_that_records_nothing():
    pass
"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow])])
def test_a_test_that_fails_leaves_its_bag(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(nodes=NODES, test_recording=RECORDING)
    result = pytester.runpytest_subprocess("--transport", transport, "--ros-bags", "bags")
    result.assert_outcomes(passed=3, failed=1)
    result.stdout.re_match_lines(
        [r".*- recorded -.*", r".*bags/test_recording.py_test_fails.mcap: \d+ messages on "]
    )
    [left] = (pytester.path / "bags").iterdir()
    for path in (left, pytester.path / "drive.mcap"):
        with Bag(path, strict=True) as bag:
            speeds = [message.data for message in bag["/speed"]]
            assert speeds[:3] == [-0.1, 0.1, 0.2]  # what the constructor published, too
            assert bag.topics["/cmd"].type_name == "geometry_msgs/msg/Twist"
            assert bag.topics["/cmd"].qos[0].depth == 10
            assert "/parameter_events" in bag


REPLAYING = """
import pytest
import rclpy
from geometry_msgs.msg import Twist
from ifgen_runtime.bag import Recorder
from nodes import Brake, Wheel
from rclpy.node import Node
from std_msgs.msg import Float64, String

START = 1_700_000_000_000_000_000


def test_record(record, ros_virtual_clock, ros_node, ros_collect):
    commands = ros_collect(Twist, "cmd")
    ros_node(Brake)
    ros_node(Wheel)
    commands.wait(60, timeout=20)
    record.save("drive.mcap")


def test_the_same_again(replay, bag):
    replayed = replay("drive.mcap", Brake)
    replayed.expect_recorded()
    assert replayed["/cmd"] == list(bag("drive.mcap")["/cmd"])
    assert [message.data for message in replayed["/texts"][:2]] == [str(START + 250_000_000), str(START + 500_000_000)]
    assert not rclpy.ok()


def test_bit_for_bit(replay):
    first = replay("drive.mcap", Brake)
    for _ in range(99):
        assert replay("drive.mcap", Brake) == first
    assert {output.topic for output in first.outputs} == {"/cmd", "/texts"}
    assert len(first["/cmd"]) == 60


def test_several_nodes(replay):
    class Follower(Node):
        def __init__(self):
            super().__init__("follower")
            self.sum = self.create_publisher(Float64, "sum", 10)
            self.create_subscription(Twist, "cmd", lambda m: self.sum.publish(Float64(data=m.linear.x)), 1)

    both = replay("drive.mcap", Brake, Follower)
    assert [m.data for m in both["/sum"]] == [m.linear.x for m in both["/cmd"]]
    assert [m.data for m in replay("drive.mcap", Follower)["/sum"]] == [m.data for m in both["/sum"]]


def test_outputs_are_a_bag(replay, bag, tmp_path):
    replayed = replay("drive.mcap", Brake, after=1.0)
    replayed.save(tmp_path / "out.mcap")
    assert [each.received for each in bag(tmp_path / "out.mcap")] == [each.time for each in replayed.outputs]


@pytest.mark.ros_strict
def test_strict(replay):
    replay("drive.mcap", Brake)


class Changed(Brake):
    gain = 3.0


def test_changed_node(replay):
    replay("drive.mcap", Changed).expect_recorded()


def test_changed_nodes(replay):
    assert replay("drive.mcap", Changed) == replay("drive.mcap", Brake)


def test_wrong_callback(replay):
    class Wrong(Brake):
        def on_speed(self, message):
            raise ValueError("no")

    replay("drive.mcap", Wrong)


def test_nothing_to_hear(replay):
    replay("drive.mcap", lambda: Node("deaf"))


def test_beside_other_nodes(replay, ros_node):
    replay("drive.mcap", Brake)


def test_nothing_in_common(replay):
    class Other(Node):
        def __init__(self):
            super().__init__("other")
            self.other = self.create_publisher(Float64, "other", 10)
            self.create_subscription(Float64, "speed", self.other.publish, 10)

    replay("drive.mcap", Other).expect_recorded()


def test_nothing_to_replay(replay, tmp_path):
    Recorder(tmp_path / "empty.mcap").close()
    replay(tmp_path / "empty.mcap", Brake)
"""


def test_replay(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(nodes=NODES, test_replaying=REPLAYING)
    result = pytester.runpytest_subprocess("--transport", "local", "-v", "-p", "no:randomly")
    result.assert_outcomes(passed=6, failed=7)
    result.stdout.fnmatch_lines(
        [
            "E*AssertionError: published now != recorded in */drive.mcap",
            "E*/cmd: message 0 of 60 is the first that differs",
            "E*  linear.x: -0.3* != -0.2",
            "E*assert Replayed == Replayed",
            "E*/cmd: message 0 of 60 is the first that differs",
            "E*linear.x: -0.3* != -0.2",
            "E*ValueError: no",
            "E*ReplayError: */drive.mcap has nothing that the nodes listen to: they subscribe to nothing, and it has *",
            "E*ReplayError: rclpy is running already: *",
            "E*AssertionError: */drive.mcap has nothing of what the nodes published: *",
            "E*ReplayError: */empty.mcap has no messages to replay",
        ]
    )


@needs_rclpy
@pytest.mark.slow
def test_replay_is_local(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_it(replay):\n    replay('x.mcap')")
    result = pytester.runpytest_subprocess("-rs", "--transport=rclpy")
    result.assert_outcomes(skipped=1)


def test_a_topic_is_added_with_its_qos_or_not_at_all(tmp_path: Path) -> None:
    """A message that comes while another one adds the topic, or after that has failed, does not add it without."""

    class Publisher:
        msg_type = Float64
        calls = 0

        @property
        def qos_profile(self) -> OfferedQoS:
            self.calls += 1
            if self.calls == 1:
                raise RuntimeError("not yet")
            return OfferedQoS(depth=7)

    recording, publisher = Recording(tmp_path / "a.mcap"), Publisher()
    for value in (1.0, 2.0):
        recording._write("/speed", publisher, Float64(data=value), 1)
    with Bag(recording.end()) as bag:
        assert [message.data for message in bag["/speed"]] == [2.0]
        assert [offer.depth for offer in bag.topics["/speed"].qos] == [7]
