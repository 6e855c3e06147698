"""What a Recorder wrote, a Bag reads: messages, times, topics, and ranges of both."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from ifgen_runtime.bag import Bag, BagError, OfferedQoS, Recorder

SECOND = 10**9


def imu(index: int) -> Any:
    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import Vector3
    from sensor_msgs.msg import Imu
    from std_msgs.msg import Header

    stamp = Time(sec=index, nanosec=7)
    return Imu(header=Header(stamp=stamp, frame_id="imu"), angular_velocity=Vector3(x=0.1 * index))


def text(data: str) -> Any:
    from std_msgs.msg import String

    return String(data=data)


def record(path: Path, **options: Any) -> Path:
    """Ten messages of an IMU, one each second, and a text after every fifth."""
    with Recorder(path, **options) as recorder:
        for index in range(10):
            recorder.write(
                "/imu", imu(index), received=index * SECOND, published=index * SECOND - (index > 0)
            )
            if index % 5 == 4:
                recorder.write("/log", text(f"{index}"), received=index * SECOND + 1)
    return path


@pytest.mark.parametrize("name", ["run.mcap", "run"])
@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_messages_come_back(tmp_path: Path, name: str, compression: str) -> None:
    from sensor_msgs.msg import Imu

    path = record(tmp_path / name, compression=compression, chunk_size=500)
    with Bag(path, strict=True) as bag:
        assert list(bag["/imu"]) == [imu(index) for index in range(10)]
        assert bag.class_of("/imu") is Imu
        assert [message.data for message in bag["/log"]] == ["4", "9"]
        assert (len(bag), bag.start, bag.end) == (12, 0, 9 * SECOND + 1)
        assert {topic.name: topic.count for topic in bag.topics.values()} == {"/imu": 10, "/log": 2}
        assert bag.topics["/imu"].type_hash == Imu.__type_hash__
        every = [(one.topic, one.received, one.published) for one in bag]
        assert every[4:7] == [
            ("/imu", 4 * SECOND, 4 * SECOND - 1),
            ("/log", 4 * SECOND + 1, 4 * SECOND + 1),
            ("/imu", 5 * SECOND, 5 * SECOND - 1),
        ]
        assert [one.message for one in bag.recorded("/log")] == [text("4"), text("9")]


def test_ranges_of_time_are_half_open(tmp_path: Path) -> None:
    with Bag(record(tmp_path / "run.mcap", chunk_size=1)) as bag:
        part = bag["/imu"].between(2 * SECOND, 4 * SECOND)
        assert list(part) == [imu(2), imu(3)]
        assert len(part) == 2
        times = [one.received for one in bag.recorded("/imu", "/log", start=8 * SECOND)]
        assert times == [8 * SECOND, 9 * SECOND, 9 * SECOND + 1]
        assert [one.topic for one in bag.recorded(end=1)] == ["/imu"]


def test_messages_are_in_the_order_of_reception_across_chunks(tmp_path: Path) -> None:
    times = [5, 1, 9, 3, 3, 8, 2, 7, 0, 6]
    with Recorder(tmp_path / "run.mcap", chunk_size=40) as recorder:
        for number, received in enumerate(times):
            recorder.write("/log", text(f"{number}"), received=received)
    with Bag(tmp_path / "run.mcap") as bag:
        found = [(one.received, int(one.message.data)) for one in bag]
    assert found == sorted((received, number) for number, received in enumerate(times))


def test_a_folder_is_split_by_size_and_by_time(tmp_path: Path) -> None:
    record(tmp_path / "by_time", split_duration=4.0)
    record(tmp_path / "by_size", split_size=2000, chunk_size=300)
    for name, least in (("by_time", 3), ("by_size", 2)):
        files = sorted(path.name for path in (tmp_path / name).glob("*.mcap"))
        assert files == [f"{name}_{number}.mcap" for number in range(len(files))]
        assert len(files) >= least
        with Bag(tmp_path / name, strict=True) as bag:
            assert list(bag["/imu"]) == [imu(index) for index in range(10)]
    (tmp_path / "by_time/metadata.yaml").unlink()  # as after a crash
    with Bag(tmp_path / "by_time", strict=True) as bag:
        assert len(bag) == 12


def test_serialised_messages_and_copies(tmp_path: Path) -> None:
    from ifgen_runtime import serialize
    from std_msgs.msg import String

    qos = SimpleNamespace(
        **{
            name: SimpleNamespace(name=word)
            for name, word in (("history", "KEEP_ALL"), ("liveliness", "AUTOMATIC"))
        },
        **{
            name: SimpleNamespace(name=word)
            for name, word in (("reliability", "BEST_EFFORT"), ("durability", "TRANSIENT_LOCAL"))
        },
        **{name: SimpleNamespace(nanoseconds=0) for name in ("deadline", "liveliness_lease_duration")},
        lifespan=SimpleNamespace(nanoseconds=1_500_000_000),
        depth=3,
        avoid_ros_namespace_conventions=False,
    )
    with Recorder(tmp_path / "a.mcap") as recorder:
        recorder.add_topic("/log", String, qos)
        recorder.add_topic("/silent", String)
        recorder.write_serialized("/log", serialize(text("a")), 5, 4)
    with Bag(tmp_path / "a.mcap", strict=True) as bag, Recorder(tmp_path / "b") as copy:
        for one in bag:
            copy.write_recorded(one)
            copy.write_recorded(one, "/again")
        assert bag.topics["/silent"].count == 0
        assert list(bag["/silent"]) == []
    offer = OfferedQoS("keep_all", 3, "best_effort", "transient_local", lifespan=1_500_000_000)
    with Bag(tmp_path / "b", strict=True) as bag:
        assert bag.topics["/log"].qos == bag.topics["/again"].qos == (offer,)
        assert [(one.received, one.published, one.message) for one in bag["/log"].recorded()] == [
            (5, 4, text("a"))
        ]


def not_there(path: Path) -> None:
    Bag(path / "nowhere")


def empty_folder(path: Path) -> None:
    Bag(path)


def no_bag(path: Path) -> None:
    (path / "a.mcap").write_text("hello, and nothing else")
    Bag(path / "a.mcap")


def of_ros_1(path: Path) -> None:
    (path / "a.bag").write_text("#ROSBAG V2.0\n")
    Bag(path / "a.bag")


def other_topic(path: Path) -> None:
    Bag(record(path / "run.mcap"))["/imo"]


def closed(path: Path) -> None:
    with Bag(record(path / "run.mcap")) as bag:
        pass
    next(iter(bag))


def there_already(path: Path) -> None:
    record(path / "run.mcap")
    Recorder(path / "run.mcap")


def no_bag_to_overwrite(path: Path) -> None:
    (path / "letters").mkdir()
    (path / "letters/one.txt").touch()
    Recorder(path / "letters", overwrite=True)


def another_type(path: Path) -> None:
    with Recorder(path / "run.mcap") as recorder:
        recorder.write("/log", text("a"))
        recorder.write("/log", imu(0))


def no_message(path: Path) -> None:
    with Recorder(path / "run.mcap") as recorder:
        recorder.write("/log", "text")


def no_topic(path: Path) -> None:
    with Recorder(path / "run.mcap") as recorder:
        recorder.write_serialized("/log", b"")


def impossible_time(path: Path) -> None:
    with Recorder(path / "run.mcap") as recorder:
        recorder.write("/log", text("a"), received=-1)


def after_the_end(path: Path) -> None:
    with Recorder(path / "run.mcap") as recorder:
        pass
    recorder.write("/log", text("a"))


def split_file(path: Path) -> None:
    Recorder(path / "run.mcap", split_size=1)


def unknown_compression(path: Path) -> None:
    Recorder(path / "run.mcap", compression="rar")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("mistake", "says"),
    [
        (not_there, "nowhere: there is no such file or folder"),
        (empty_folder, "this is no bag: there is no .mcap and no .db3 file in the folder"),
        (no_bag, "a.mcap: this is no MCAP file: it does not begin as one"),
        (of_ros_1, "a bag of ROS 1. `rosbags-convert` of the library rosbags turns it into one of ROS 2"),
        (other_topic, "there is no topic '/imo': it has /imu"),
        (closed, "run.mcap: this bag is closed"),
        (there_already, "run.mcap exists already: choose another name, or overwrite it"),
        (no_bag_to_overwrite, "letters is no bag, so it is not overwritten: it has no metadata.yaml"),
        (another_type, "/log has messages of std_msgs/msg/String, and this is one of sensor_msgs/msg/Imu"),
        (no_message, "str is no message class, and /log needs one"),
        (no_topic, "/log has no type yet: call add_topic first"),
        (impossible_time, "a time of -1 or -1 ns cannot be recorded"),
        (after_the_end, "the recording is complete: nothing more can be written"),
        (split_file, "only a folder can have several files: leave the ending .mcap out"),
        (unknown_compression, "there is no compression 'rar': use zstd, lz4 or none"),
    ],
)
def test_mistakes(tmp_path: Path, mistake: Callable[[Path], None], says: str) -> None:
    with pytest.raises(BagError) as raised:
        mistake(tmp_path)
    assert says in str(raised.value)


def test_overwriting_replaces_a_bag(tmp_path: Path) -> None:
    for name in ("run.mcap", "run"):
        record(tmp_path / name)
        with Recorder(tmp_path / name, overwrite=True) as recorder:
            recorder.write("/log", text("new"))
        with Bag(tmp_path / name) as bag:
            assert [message.data for message in bag["/log"]] == ["new"]
            assert list(bag.topics) == ["/log"]


def test_a_bag_that_nobody_holds_is_read_to_its_end(tmp_path: Path) -> None:
    path = record(tmp_path / "run.mcap", chunk_size=1)
    assert sum(1 for _ in Bag(path)) == 12
    assert list(Bag(path)["/imu"]) == [imu(index) for index in range(10)]
    assert [one.topic for one in Bag(path).recorded("/log")] == ["/log"] * 2


def test_databases(tmp_path: Path) -> None:
    path = record(tmp_path / "run.db3")
    assert path.is_file()
    with Bag(path, strict=True) as bag:
        assert list(bag["/imu"]) == [imu(index) for index in range(10)]
    with pytest.raises(BagError, match="only an MCAP file has room for metadata="):
        Recorder(tmp_path / "other.db3", metadata={"robot": "walker"})
    with pytest.raises(
        BagError, match=r"x\.bag is the name of a file, and ifgen writes none that ends in \.bag"
    ):
        Recorder(tmp_path / "x.bag")


def test_metadata_is_written_although_closing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder(tmp_path / "run")
    recorder.write("/log", text("a"), received=5)
    recorder.flush()
    recorder.write("/log", text("b"), received=6)

    def full(*_: Any) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("ifgen_runtime.bag.mcap.writer._write", full)
    with pytest.raises(
        BagError, match=r"cannot be written any further: No space left on device\. It has 1 messages"
    ):
        recorder.close()
    metadata = (tmp_path / "run/metadata.yaml").read_text()
    assert "\n  message_count: 1\n" in metadata, "what is in the file, not what was to be"
    assert [path.name for path in sorted((tmp_path / "run").iterdir())] == ["metadata.yaml", "run_0.mcap"]
