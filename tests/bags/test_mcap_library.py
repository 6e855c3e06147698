"""Recordings of ours in the libraries mcap and mcap-ros2-support, and theirs in ours."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import mcap_ros2.writer
import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime import serialize
from ifgen_runtime.bag import Bag, BagError, Recorder
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from mcap_ros2.decoder import DecoderFactory

COW = "string name\nfarm_msgs/Leg[] legs\nstd_msgs/Header header\n"
SEPARATOR = "=" * 80
NEEDED = f"""{COW}{SEPARATOR}
MSG: farm_msgs/Leg
# of a cow
uint8 LEFT=1
int16 length 5  # [mm]
{SEPARATOR}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{SEPARATOR}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
COW_IDL = f"""{SEPARATOR}
IDL: farm_msgs/msg/Cow
#include "farm_msgs/msg/Leg.idl"
module farm_msgs {{ module msg {{
  struct Cow {{ string name; sequence<farm_msgs::msg::Leg> legs; }};
}}; }};
{SEPARATOR}
IDL: farm_msgs/msg/Leg
module farm_msgs {{ module msg {{
  struct Leg {{ int16 length; }};
}}; }};
"""


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_what_the_library_reads_of_ours(tmp_path: Path, compression: Any) -> None:
    from sensor_msgs.msg import JointState
    from std_msgs.msg import String

    path = tmp_path / "run.mcap"
    with Recorder(path, compression=compression, chunk_size=500, metadata={"robot": "h1"}) as recorder:
        for index in range(30):
            joints = JointState(name=["knee"], position=[0.1 * index])
            recorder.write("/joints", joints, received=2000 - index, published=5)
            recorder.write("/log", String(data=f"ü{index}"), received=2000)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        found = [(c.topic, m.log_time, m.publish_time, d) for _, c, m, d in reader.iter_decoded_messages()]
        (about,) = reader.iter_metadata()
        summary = reader.get_summary()
    assert [time for _, time, _, _ in found] == sorted(time for _, time, _, _ in found)
    joints = [(time, published, d.position[0]) for topic, time, published, d in found if topic == "/joints"]
    assert joints == [(2000 - index, 5, 0.1 * index) for index in range(29, -1, -1)]
    assert [d.data for topic, _, _, d in found if topic == "/log"] == [f"ü{index}" for index in range(30)]
    assert (about.name, about.metadata) == ("ifgen", {"robot": "h1"})
    assert summary is not None and summary.statistics is not None
    assert summary.statistics.message_count == 60
    assert len(summary.chunk_indexes) == summary.statistics.chunk_count > 3
    metadata = {channel.topic: channel.metadata for channel in summary.channels.values()}
    assert metadata["/log"] == {"offered_qos_profiles": "", "topic_type_hash": String.__type_hash__}


@pytest.mark.parametrize("compression", list(CompressionType), ids=lambda each: each.name.lower())
@pytest.mark.parametrize("index", [IndexType.ALL, IndexType.NONE], ids=["indexed", "plain"])
@pytest.mark.parametrize("chunking", [True, False], ids=["chunks", "no-chunks"])
def test_what_the_library_wrote(tmp_path: Path, compression: Any, index: Any, chunking: bool) -> None:
    from std_msgs.msg import String

    path = tmp_path / "run.mcap"
    writer = McapWriter(str(path), 300, compression, index, use_chunking=chunking)
    writer.start("ros2", "a test")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data # a text\n")
    channel = writer.register_channel("/log", "cdr", schema)
    other = writer.register_channel("/other", "cdr", schema)
    writer.add_metadata("about", {"a": "b"})
    for number in range(100):
        time = (number * 37) % 100
        data = serialize(String(data=f"{number}"))
        writer.add_message(channel if number % 3 else other, time, data, time + 1)
    writer.add_attachment(0, 0, "a.txt", "text/plain", b"attached")
    writer.finish()
    expected = sorted((number * 37 % 100, number) for number in range(100))
    with Bag(path, strict=True) as bag:
        assert [(one.received, int(one.message.data)) for one in bag] == expected
        assert [int(message.data) for message in bag["/log"]] == [n for _, n in expected if n % 3]
        assert bag.class_of("/log") is String
        assert (len(bag["/log"]), bag.start, bag.end) == (66, 0, 99)
        assert [one.published for one in bag.recorded(start=7, end=9)] == [8, 9]


def test_a_type_that_nobody_installed(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with path.open("wb") as file:
        writer = mcap_ros2.writer.Writer(file)
        schema = writer.register_msgdef("farm_msgs/msg/Cow", NEEDED)
        for index in range(5):
            legs = [{"length": 10 * index}] * index
            cow = {"name": f"cow {index}", "legs": legs, "header": {"frame_id": "barn"}}
            writer.write_message("/cows", schema, cow, index)
        writer.finish()
    with Bag(path, strict=True) as bag:
        cows = list(bag["/cows"])
        assert [(cow.name, [leg.length for leg in cow.legs]) for cow in cows][3] == ("cow 3", [30, 30, 30])
        assert cows[0].header.frame_id == "barn"
        assert type(cows[1].legs[0])().LEFT == 1
        assert bag["/cows"].column("header.frame_id").tolist() == ["barn"] * 5
        with Recorder(tmp_path / "copy.mcap") as recorder:
            for one in bag:
                recorder.write_recorded(one)
            recorder.write("/made", cows[2])
    with Bag(tmp_path / "copy.mcap", strict=True) as bag:
        assert list(bag["/cows"]) == cows
        assert list(bag["/made"]) == [cows[2]]


def raw(path: Path, name: str, encoding: str, text: str, data: bytes, **about: Any) -> Bag:
    """A bag of one message."""
    writer = McapWriter(str(path))
    writer.start("ros2", "a test")
    schema = writer.register_schema(name, encoding, text.encode())
    serialization = about.pop("serialization", "cdr")
    writer.add_message(writer.register_channel("/t", serialization, schema, about), 1, data, 1)
    writer.finish()
    return Bag(path)


def test_definitions_in_idl(tmp_path: Path) -> None:
    data = b"\0\1\0\0" + b"\4\0\0\0Ada\0" + b"\1\0\0\0" + b"\7\0"
    with raw(tmp_path / "run.mcap", "farm_msgs/msg/Cow", "ros2idl", COW_IDL, data) as bag:
        (cow,) = bag["/t"]
        assert (cow.name, cow.legs[0].length) == ("Ada", 7)


WALK_SRV = f"""{SEPARATOR}
SRV: farm_msgs/srv/Walk
farm_msgs/Leg[] legs
float64 speed 0.5
---
bool done
{SEPARATOR}
MSG: farm_msgs/Leg
int16 length
"""
"""The definition of a service event, as rosbag2 writes it."""


def test_service_events_of_rosbag2(tmp_path: Path) -> None:
    cls = class_from_text("farm_msgs/srv/Walk", WALK_SRV)
    event = cls.Event()
    event.info.event_type, event.info.sequence_number = 1, 7
    event.request = [cls.Request(speed=0.1)]
    with raw(tmp_path / "run.mcap", "farm_msgs/srv/Walk_Event", "ros2msg", WALK_SRV, serialize(event)) as bag:
        (found,) = bag["/t"]
        assert type(found) is type(event)
        assert (found.info.sequence_number, found.request[0].speed, found.response) == (7, 0.1, [])


def test_what_belongs_to_services_and_actions_of_ours(tmp_path: Path) -> None:
    """Nobody has these types: they are read by what is in the file."""
    walk = class_from_text("farm_msgs/srv/Walk", WALK_SRV)
    go = class_from_text("farm_msgs/action/Go", "int8 far\n---\nbool there\n---\nfloat32 left\nbyte[3] x\n")
    event = walk.Event(response=[walk.Response(done=True)])
    feedback = go.Impl.FeedbackMessage(feedback=go.Feedback(left=0.1))
    goal = go.Impl.SendGoalService.Request(goal=go.Goal(far=3))
    with Recorder(tmp_path / "run.mcap") as recorder:
        for name, message in (("/event", event), ("/feedback", feedback), ("/goal", goal)):
            recorder.write(name, message)
    with Bag(tmp_path / "run.mcap", strict=True) as bag:
        (read,) = bag["/event"]
        assert (len(read.request), read.response[0].done) == (0, True)
        assert [round(each.feedback.left, 6) for each in bag["/feedback"]] == [0.1]
        assert [each.goal.far for each in bag["/goal"]] == [3]
        hashes = {name: bag.topics[name].type_hash for name in bag.topics}
    kinds = {"/event": event, "/feedback": feedback, "/goal": goal}
    assert hashes == {name: type(message).__type_hash__ for name, message in kinds.items()}


@pytest.mark.parametrize(
    ("text", "is_installed"),
    [
        ("string data\n", True),
        ("# said\n\nstring   data  # by somebody\nstring A=b\n", True),
        ("string data 'hello'\n", True),
        ("string<=10 data\n", False),
        ("string text\n", False),
        ("string data\nstring more\n", False),
    ],
)
def test_the_installed_class_is_used_if_its_definition_is_the_same(
    tmp_path: Path, text: str, is_installed: bool
) -> None:
    from std_msgs.msg import String

    with raw(
        tmp_path / "run.mcap", "std_msgs/msg/String", "ros2msg", text, serialize(String(data="a"))
    ) as bag:
        assert (bag.class_of("/t") is String) is is_installed


def test_the_hash_decides_before_the_text(tmp_path: Path) -> None:
    from std_msgs.msg import String

    data = serialize(String(data="a"))
    hashed = {"topic_type_hash": String.__type_hash__}
    with raw(tmp_path / "a.mcap", "std_msgs/msg/String", "ros2msg", "int32 wrong\n", data, **hashed) as bag:
        assert list(bag["/t"]) == [String(data="a")]
    hashed = {"topic_type_hash": "RIHS01_" + 64 * "0"}
    says = "the definition of std_msgs/msg/String in it has not the type hash that /t was"
    bag = raw(tmp_path / "b.mcap", "std_msgs/msg/String", "ros2msg", "string data\n", data, **hashed)
    with bag, pytest.warns(match=says):
        assert [message.data for message in bag["/t"]] == ["a"]


@pytest.mark.parametrize(
    ("name", "encoding", "text", "serialization", "says"),
    [
        (
            "std_msgs/msg/String",
            "ros2msg",
            "string data",
            "json",
            "messages of /t are encoded as 'json', and ifgen reads cdr",
        ),
        (
            "farm_msgs/msg/Cow",
            "",
            "",
            "cdr",
            "there is no class for farm_msgs/msg/Cow of /t: no installed package has it",
        ),
        (
            "farm_msgs/msg/Cow",
            "ros2msg",
            "cow cow cow",
            "cdr",
            "the definition of farm_msgs/msg/Cow in it cannot be used: ",
        ),
        ("../../etc", "ros2msg", "string data", "cdr", "the definition of ../../etc in it cannot be used: "),
        ("", "ros2msg", "string data", "cdr", "cannot be used: "),
    ],
)
def test_types_that_cannot_be_read(
    tmp_path: Path, name: str, encoding: str, text: str, serialization: str, says: str
) -> None:
    with raw(tmp_path / "run.mcap", name, encoding, text, b"\0\1\0\0", serialization=serialization) as bag:
        with pytest.raises(BagError, match=re.escape(says)):
            list(bag["/t"])
        assert [one.data for one in bag] == [b"\0\1\0\0"]


def test_without_the_toolkit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: ())
    says = r"no installed package has it\. The toolkit makes one from the file: .*pip install"
    bag = raw(tmp_path / "run.mcap", "farm_msgs/msg/Cow", "ros2msg", "string name", b"\0\1\0\0")
    with bag, pytest.raises(BagError, match=says):
        list(bag["/t"])


def test_classes_that_are_given(tmp_path: Path) -> None:
    from std_msgs.msg import Int32, String

    path = tmp_path / "run.mcap"
    raw(path, "farm_msgs/msg/Cow", "", "", serialize(String(data="a"))).close()
    with Bag(path, classes={"farm_msgs/msg/Cow": String}) as bag:
        assert list(bag["/t"]) == [String(data="a")]
    with Bag(path, classes={"farm_msgs/msg/Cow": Int32}, strict=True) as bag:
        assert list(bag["/t"]) == [Int32(data=2)]
