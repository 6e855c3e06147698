"""`ifgen bag record`, while nodes of the same process publish."""

from __future__ import annotations

import re
import signal
import threading
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

import ifgen.dynamic
import pytest
import rclpy
from geometry_msgs.msg import Point
from ifgen.command_kit.tool import ToolError
from ifgen_runtime.bag import Bag, writer
from ifgen_runtime.bag.writer import BagWriter
from ifgen_tools.bag.options import RecordOptions
from ifgen_tools.bag.record import Recording, record
from ifgen_tools.bag.recorder import TopicRecorder
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tests.cli.conftest import Run

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@contextmanager
def spinning(name: str) -> Iterator[Node]:
    """A node that spins in a thread: it answers questions about its types."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node(name, context=context)
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


@pytest.fixture
def talker() -> Iterator[Node]:
    with spinning("talker") as node:
        yield node


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


def command(output: str, *topics: str, **choices: Any) -> RecordOptions:
    """The options that record these topics, or all if none is named."""
    return RecordOptions(
        topics=topics,
        all_topics=not topics,
        exclude_topics=("/rosout",),
        output=Path(output),
        polling_interval=10,
        transport="local",
        **choices,
    )


def points(count: int) -> list[Point]:
    return [Point(x=0.1 * index) for index in range(count)]


def run(options: RecordOptions, is_done: Callable[[Recording], bool]) -> None:
    assert record(options, is_done) == 0


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
        {},
        {"storage": "sqlite3"},
        {"storage": "sqlite3", "compression_mode": "file", "compression_format": "zstd"},
    ],
    ids=["mcap", "sqlite3", "compressed"],
)
def test_files_are_split(talker: Node, choices: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    run(command("drive", "/position", max_bag_size=100, **choices), Talk(publisher, points(20)))
    with Bag("drive", strict=True) as bag:
        assert len(bag.files) == 5  # of 4 messages of 28 bytes
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(20)]
        first, second = (file.name for file in bag.files[:2])
    assert f"{first} is full, going on in {second.removesuffix('.zstd')}\n" in capsys.readouterr().err


def test_only_the_last_files_are_kept(talker: Node) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    run(command("drive", "/position", max_bag_size=100, max_bag_files=2), Talk(publisher, points(20), 8))
    with Bag("drive", strict=True) as bag:
        assert [file.name for file in bag.files] == ["drive_3.mcap", "drive_4.mcap"]
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(12, 20)]


def test_messages_that_are_compressed_one_by_one(talker: Node) -> None:
    publisher = talker.create_publisher(String, "text", 10)
    choices = {"storage": "sqlite3", "compression_mode": "message", "compression_format": "zstd"}
    run(command("drive", "/text", **choices), Talk(publisher, [String(data="walk " * 99)]))
    with Bag("drive", strict=True) as bag:
        assert [text.data for text in bag["/text"]] == ["walk " * 99]


def test_a_snapshot(talker: Node) -> None:
    publisher = talker.create_publisher(Point, "position", 100)
    waiting = points(20)

    def is_done(recording: Recording) -> bool:
        Talk(publisher, waiting)(recording)
        return not waiting and recording.snapshot()

    run(command("drive", "/position", snapshot_mode=True, max_cache_size=100), is_done)
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

    run(command("drive", "/position", start_paused=True), is_done)
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

    monkeypatch.setattr("ifgen_tools.bag.recorder.class_with_hash", refuse)
    talker.create_publisher(ifgen.dynamic.class_from_text("lab_msgs/msg/Speed", "float64 v\n"), "speed", 10)
    talk, said = Talk(talker.create_publisher(Point, "position", 10), points(3)), list[str]()

    def is_done(recording: Recording) -> bool:
        said.append(capsys.readouterr().err)
        return talk(recording) and "warning: /speed is not recorded: nobody describes it\n" in "".join(said)

    run(command("drive"), is_done)
    with Bag("drive", strict=True) as bag:
        assert len(bag["/position"]) == 3


def test_another_type_on_a_recorded_topic(talker: Node, capsys: pytest.CaptureFixture[str]) -> None:
    """Another process may publish it; its topic is recorded with the type that came first."""
    said = ""
    talk = Talk(talker.create_publisher(Point, "position", 10), points(3))
    with spinning("stranger") as stranger:

        def is_done(recording: Recording) -> bool:
            nonlocal said
            if talk(recording) and not stranger.publishers_info:
                stranger.publishers_info = stranger.create_publisher(String, "position", 10)
            said += capsys.readouterr().err
            return "are not recorded" in said

        stranger.publishers_info = None
        run(command("drive", "/position"), is_done)
    assert (
        "warning: /position is recorded with messages of geometry_msgs/msg/Point: "
        "those of std_msgs/msg/String are not recorded\n"
    ) in said
    with Bag("drive", strict=True) as bag:
        assert {topic.name: topic.count for topic in bag.topics.values()} == {"/position": 3}


def test_small_messages_do_not_wait_for_images(talker: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    """A topic takes turns of a megabyte."""
    order: list[str] = []
    whole = BagWriter.write

    def note(self: BagWriter, channel: Any, *message: Any) -> None:
        order.append(channel.topic)
        whole(self, channel, *message)

    monkeypatch.setattr(BagWriter, "write", note)
    images, small = (talker.create_publisher(String, name, 100) for name in ("images", "small"))
    waiting = [String(data="walk" * 100_000)] * 30

    def is_done(_: Recording) -> bool:
        if images.get_subscription_count() and small.get_subscription_count():
            while waiting:
                images.publish(waiting.pop())
                small.publish(String(data="walk"))
        return len(order) >= 60

    run(command("drive"), is_done)
    assert Counter(order) == {"/images": 30, "/small": 30}
    assert order.index("/small") <= 3
    assert order[3:36].count("/small") == 30, "all of them wait for one turn"


def test_what_the_memory_has_no_room_for_is_counted(
    talker: Node, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """While the first message is written, more than the middleware holds at once comes in two bursts."""
    monkeypatch.setattr("ifgen_tools.bag.recorder._DEPTH", 30)
    monkeypatch.setattr("ifgen_tools.bag.recorder._BYTES_AT_ONCE", 1)
    publisher = talker.create_publisher(Point, "position", 30)
    bursts = [points(30), points(30)]
    whole = BagWriter.write

    def slow(self: BagWriter, channel: Any, *message: Any) -> None:
        whole(self, channel, *message)
        for point in bursts.pop() if bursts else ():
            publisher.publish(point)

    monkeypatch.setattr(BagWriter, "write", slow)

    def is_done(recording: Recording) -> bool:
        if publisher.get_subscription_count() and len(bursts) == 2 and not recording.topics.has_waiting:
            for point in points(10):
                publisher.publish(point)
        return not bursts and not recording.topics.has_waiting

    run(command("drive", "/position", max_waiting_size=20 * (200 + 28)), is_done)
    with Bag("drive", strict=True) as bag:
        recorded = len(bag["/position"])
    found = re.search(r"warning: (\d+) messages of /position were received, and not", capsys.readouterr().err)
    assert found is not None
    assert recorded + int(found[1]) == 70
    assert recorded >= 20


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("name", ["drive", "drive.db3"])
def test_what_waits_at_the_end_is_recorded(
    talker: Node,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    number: signal.Signals,
    name: str,
) -> None:
    monkeypatch.setattr("ifgen_tools.bag.record._ON_ITS_WAY", 0.0)
    monkeypatch.setattr("ifgen_tools.bag.recorder._AT_ONCE", 100)
    talk = Talk(talker.create_publisher(Point, "position", 1000), points(900))

    def is_done(recording: Recording) -> bool:
        if not (talk(recording) or not talk._messages):
            return False
        signal.raise_signal(number)
        return True  # nothing is taken any more but at the end

    with pytest.raises(KeyboardInterrupt):
        run(command(name, "/position"), is_done)
    assert capsys.readouterr().err.endswith(f"Recorded 900 messages to {name}\n")
    with Bag(name, strict=True) as bag:
        assert [point.x for point in bag["/position"]] == [0.1 * index for index in range(900)]


def test_what_nobody_waits_for_is_counted(
    talker: Node, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A second Ctrl-C leaves out what waits."""
    monkeypatch.setattr("ifgen_tools.bag.record._ON_ITS_WAY", 0.0)
    publishers = [talker.create_publisher(Point, name, 1000) for name in ("position", "goal")]

    def is_done(_: Recording) -> bool:
        if not all(publisher.get_subscription_count() for publisher in publishers):
            return False
        for publisher, number in zip(publishers, (900, 1), strict=True):
            for point in points(number):
                publisher.publish(point)
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        return True

    recording = command("drive", "/position", "/goal")
    with pytest.raises(KeyboardInterrupt):
        run(recording, is_done)
    said = capsys.readouterr().err
    with Bag("drive", strict=True) as bag:
        counts = {topic.name: topic.count for topic in bag.topics.values()}
    left = {
        topic: int(count.replace(",", ""))
        for count, topic in re.findall(r"warning: ([\d,]+) messages? of (\S+) w\w+ received, and not", said)
    }
    assert counts == {"/position": 0, "/goal": 0}
    assert left == {"/position": 900, "/goal": 1}


def test_a_full_disk_is_said_and_what_was_written_stays(
    talker: Node, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any) -> int:
        raise OSError(28, "No space left on device")

    def is_done(recording: Recording) -> bool:
        if talk(recording):
            recording.writer.flush()
            monkeypatch.setattr("ifgen_runtime.bag.mcap.writer._write", full)
            recording.writer.split()
        return False

    talk = Talk(talker.create_publisher(Point, "position", 100), points(20))
    with pytest.raises(ToolError, match="cannot be written any further: No space left on device") as raised:
        run(command("drive", "/position"), is_done)
    assert raised.value.help == "make room, or name a place on another disk with -o"
    assert capsys.readouterr().err.endswith("Recorded 20 messages to drive\n")
    text = Path("drive/metadata.yaml").read_text()
    assert "message_count: 20\n" in text, "the metadata says what is there, although closing failed"


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_message_is_in_the_file_soon(talker: Node, monkeypatch: pytest.MonkeyPatch, storage: str) -> None:
    """Also if no other follows: a recorder that is killed keeps it."""
    monkeypatch.setattr(writer, "_SECONDS", 0.01)
    turns = count()
    talk = Talk(talker.create_publisher(Point, "position", 10), points(1))

    def is_done(recording: Recording) -> bool:
        if not talk(recording):
            return False
        assert next(turns) < 50, "a look takes a tenth of a second"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it is not complete
            with Bag(recording.writer.files[0]) as bag:
                return [recorded.topic for recorded in bag] == ["/position"]

    run(command("drive", storage=storage), is_done)


def test_what_exists_stays(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / "drive").mkdir()
    outcome = ifgen("bag", "record", "--transport", "local", "-a", "-o", "drive")
    said = "error: drive exists already\n  = help: name another place with -o, or delete it first\n"
    assert (outcome.code, outcome.err) == (1, said)


def test_a_single_file_is_not_split(ifgen: Run) -> None:
    outcome = ifgen("bag", "record", "--transport", "local", "-a", "-o", "drive.mcap", "-b", "1000")
    assert "drive.mcap is a single file, and cannot be split or compressed as a whole" in outcome.err
