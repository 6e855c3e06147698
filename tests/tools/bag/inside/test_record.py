"""`ifgen bag record`, while nodes of the same process publish."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import ifgen.dynamic
import pytest
import rclpy
from geometry_msgs.msg import Point
from ifgen_runtime.bag import Bag
from ifgen_runtime.bag.writer import Limits
from ifgen_tools.bag.choices import file_format
from ifgen_tools.bag.recording.record import RecordCommand, Recording, record
from ifgen_tools.bag.recording.recorder import TopicRecorder
from ifgen_tools.bag.selection import selection
from ifgen_tools.errors import ToolError
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tests.cli.conftest import Run

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def talker() -> Iterator[Node]:
    """A node that spins in a thread: it answers questions about its types."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node("talker", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def spin() -> None:
        with suppress(ExternalShutdownException):
            executor.spin()

    thread = threading.Thread(target=spin)
    thread.start()
    yield node
    context.shutdown()
    thread.join()
    node.destroy_node()


class Talk:
    """Publishes messages once somebody listens, and says when `count` messages have been recorded."""

    def __init__(self, publisher: Publisher[Any], messages: list[Any], count: int | None = None) -> None:
        self._publisher = publisher
        self._messages = messages
        self._count = len(messages) if count is None else count

    def __call__(self, recording: Recording) -> bool:
        if self._publisher.get_subscription_count():
            while self._messages:
                self._publisher.publish(self._messages.pop(0))
        return recording.writer.count >= self._count


def command(output: str, *topics: str, **choices: Any) -> RecordCommand:
    """The command that records these topics, or all if none is named."""
    path = Path(output)
    return RecordCommand(
        selection(topics=topics, all_topics=not topics, exclude_topics=["/rosout"]),
        path,
        **{"format": file_format(storage=None, output=path), "interval": 0.01, **choices},
    )


def points(count: int) -> list[Point]:
    return [Point(x=0.1 * index) for index in range(count)]


def run(command: RecordCommand, is_done: Callable[[Recording], bool]) -> None:
    assert record("local", command, is_done) == 0


def test_all_topics(talker: Node, capsys: pytest.CaptureFixture[str]) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    run(command("drive"), Talk(publisher, points(20)))
    with Bag("drive", strict=True) as bag:
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(20)]
        assert bag.topics["/position"].qos[0].reliability == "reliable"
        assert bag.ros_distro == "jazzy"
    said = capsys.readouterr().err
    assert "Subscribed to topic '/position'\n" in said
    assert said.endswith("Recorded 20 messages to drive\n")


@pytest.mark.parametrize("name", ["drive.mcap", "drive.db3"])
def test_topics_that_come_later_and_what_was_said_before(talker: Node, name: str) -> None:
    talker.create_publisher(String, "mode", LATCHED).publish(String(data="walk"))
    talks: list[Talk] = []

    def is_done(recording: Recording) -> bool:
        if recording.writer.count == 1 and not talks:
            talks.append(Talk(talker.create_publisher(Point, "position", 100), points(5), 6))
        return bool(talks) and talks[0](recording)

    run(command(name, "/position", "/mode"), is_done)
    with Bag(name, strict=True) as bag:
        assert [mode.data for mode in bag["/mode"]] == ["walk"]
        assert bag.topics["/mode"].qos[0].durability == "transient_local"
        assert len(bag["/position"]) == 5


def test_a_type_that_nobody_generated(talker: Node) -> None:
    text = "# As measured.\nfloat64 value 0.1  # [m/s]\n"
    cls = ifgen.dynamic.class_from_text("lab_msgs/msg/Speed", text)
    publisher = talker.create_publisher(cls, "speed", 10)
    run(command("drive", "/speed"), Talk(publisher, [cls(value=0.3)] * 3))
    with Bag("drive", strict=True) as bag:
        assert [message.value for message in bag["/speed"]] == [0.3] * 3
        (definition,) = bag.topics["/speed"].definitions
        assert definition.type_hash == cls.__type_hash__
        assert definition.text == text


def test_publishers_that_offer_different_things(talker: Node, capsys: pytest.CaptureFixture[str]) -> None:
    best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    talker.create_publisher(Point, "position", 10)
    publisher = talker.create_publisher(Point, "position", best_effort)
    run(command("drive", "/position"), Talk(publisher, points(3)))
    said = capsys.readouterr().err
    assert "warning: some, but not all, publishers on /position offer more reliability" in said
    with Bag("drive", strict=True) as bag:
        assert {qos.reliability for qos in bag.topics["/position"].qos} == {"reliable", "best_effort"}


@pytest.mark.parametrize(
    "choices",
    [
        {"limits": Limits(size=100)},
        {"format": file_format(storage="sqlite3", output=None), "limits": Limits(size=100)},
        {
            "format": file_format(storage="sqlite3", output=None, mode="file", compression="zstd"),
            "limits": Limits(size=100),
        },
    ],
    ids=["mcap", "sqlite3", "compressed"],
)
def test_files_are_split(talker: Node, choices: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    run(command("drive", "/position", **choices), Talk(publisher, points(20)))
    with Bag("drive", strict=True) as bag:
        assert len(bag.files) == 5  # of 4 messages of 28 bytes
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(20)]
        first, second = (file.name for file in bag.files[:2])
    assert f"{first} is full, going on in {second.removesuffix('.zstd')}\n" in capsys.readouterr().err


def test_only_the_last_files_are_kept(talker: Node) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    limits = Limits(size=100, files=2)
    run(command("drive", "/position", limits=limits), Talk(publisher, points(20), 8))
    with Bag("drive", strict=True) as bag:
        assert [file.name for file in bag.files] == ["drive_3.mcap", "drive_4.mcap"]
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(12, 20)]


def test_messages_that_are_compressed_one_by_one(talker: Node) -> None:
    publisher = talker.create_publisher(String, "text", 10)
    choice = file_format(storage="sqlite3", output=None, mode="message", compression="zstd")
    run(command("drive", "/text", format=choice), Talk(publisher, [String(data="walk " * 99)]))
    with Bag("drive", strict=True) as bag:
        assert [text.data for text in bag["/text"]] == ["walk " * 99]


def test_a_snapshot(talker: Node) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    waiting = points(20)

    def is_done(recording: Recording) -> bool:
        Talk(publisher, waiting)(recording)
        return not waiting and recording.snapshot()

    run(command("drive", "/position", snapshot_size=100), is_done)
    with Bag("drive", strict=True) as bag:
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(17, 20)]


def test_nothing_is_recorded_while_paused(talker: Node, capsys: pytest.CaptureFixture[str]) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    looks: list[int] = []

    def is_done(recording: Recording) -> bool:
        if publisher.get_subscription_count():
            publisher.publish(Point())
            looks.append(recording.writer.count)
            if len(looks) == 5:
                recording.toggle()
        return recording.writer.count > 0

    run(command("drive", "/position", is_paused=True), is_done)
    assert looks[:5] == [0] * 5
    said = capsys.readouterr().err
    assert said.startswith("Recording to drive. Press Ctrl-C to stop\n")
    assert "Recording resumed\n" in said


def test_what_was_lost_is_said(
    talker: Node, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(TopicRecorder, "lost", {"/position": 1, "/scan": 1200})
    run(command("drive", "/position"), Talk(talker.create_publisher(Point, "position", 10), points(1)))
    assert capsys.readouterr().err.endswith(
        "warning: on the way here, 1 message of /position was lost\n"
        "warning: on the way here, 1,200 messages of /scan were lost\n"
    )


def test_a_type_that_nobody_describes(
    talker: Node, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> None:
        raise ToolError("nobody describes it")

    monkeypatch.setattr("ifgen_tools.bag.recording.recorder.class_with_hash", refuse)
    talker.create_publisher(ifgen.dynamic.class_from_text("lab_msgs/msg/Speed", "float64 v\n"), "speed", 10)
    talk, said = Talk(talker.create_publisher(Point, "position", 10), points(3)), list[str]()

    def is_done(recording: Recording) -> bool:
        said.append(capsys.readouterr().err)
        return talk(recording) and "warning: /speed is not recorded: nobody describes it\n" in "".join(said)

    run(command("drive"), is_done)
    with Bag("drive", strict=True) as bag:
        assert len(bag["/position"]) == 3


def test_what_exists_stays(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / "drive").mkdir()
    outcome = ifgen("bag", "record", "--transport", "local", "-a", "-o", "drive")
    said = "error: drive exists already\n  = help: name another place with -o, or delete it first\n"
    assert (outcome.code, outcome.err) == (1, said)


def test_a_single_file_is_not_split(ifgen: Run) -> None:
    outcome = ifgen("bag", "record", "--transport", "local", "-a", "-o", "drive.mcap", "-b", "1000")
    assert "drive.mcap is a single file, and cannot be split or compressed as a whole" in outcome.err
