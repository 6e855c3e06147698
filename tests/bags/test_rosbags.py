"""Recordings of ours in rosbags, and those of rosbags in ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ifgen_runtime.bag import Bag, Recorder
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
STORE.register(
    get_types_from_msg("string name\nfarm_msgs/Leg[<=4] legs\nfloat32[3] eye\n", "farm_msgs/msg/Cow")
    | get_types_from_msg("int16 length\nstd_msgs/Header header\n", "farm_msgs/msg/Leg")
)
QOS = Qos(
    QosHistory.KEEP_LAST,
    7,
    QosReliability.BEST_EFFORT,
    QosDurability.TRANSIENT_LOCAL,
    QosTime(0, 100_000_000),
    QosTime(9223372036, 854775807),
    QosLiveliness.AUTOMATIC,
    QosTime(0, 0),
    avoid_ros_namespace_conventions=False,
)


def header(index: int) -> Any:
    time = STORE.types["builtin_interfaces/msg/Time"](sec=index, nanosec=5)
    return STORE.types["std_msgs/msg/Header"](stamp=time, frame_id="world")


def cow(index: int) -> Any:
    import numpy as np

    leg = STORE.types["farm_msgs/msg/Leg"]
    legs = [leg(length=100 * index + number, header=header(index)) for number in range(index % 5)]
    eye = np.array([0.1, 0.2, index], np.float32)
    return STORE.types["farm_msgs/msg/Cow"](name=f"cow {index}", legs=legs, eye=eye)


def written_by_rosbags(
    path: Path, version: Any, storage: StoragePlugin, compression: CompressionMode = CompressionMode.NONE
) -> Path:
    writer = Writer(path, version=version, storage_plugin=storage)
    writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        cows = writer.add_connection(
            "/cows", "farm_msgs/msg/Cow", typestore=STORE, offered_qos_profiles=[QOS]
        )
        headers = writer.add_connection("/headers", "std_msgs/msg/Header", typestore=STORE)
        for index in range(20):
            writer.write(cows, 10 * index, STORE.serialize_cdr(cow(index), "farm_msgs/msg/Cow"))
            writer.write(headers, 10 * index + 3, STORE.serialize_cdr(header(index), "std_msgs/msg/Header"))
    return path


@pytest.mark.parametrize("version", [8, 9])
@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP], ids=["sqlite3", "mcap"])
@pytest.mark.parametrize(
    "compression",
    [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE],
    ids=["none", "file", "message"],
)
def test_what_rosbags_wrote(tmp_path: Path, version: int, storage: Any, compression: Any) -> None:
    from std_msgs.msg import Header

    path = written_by_rosbags(tmp_path / "bag", version, storage, compression)
    with Bag(path, strict=True) as bag:
        cows, headers = list(bag["/cows"]), list(bag["/headers"])
        assert [(found.name, len(found.legs)) for found in cows] == [(f"cow {n}", n % 5) for n in range(20)]
        assert cows[9].legs[3].length == 903
        assert cows[9].legs[3].header.frame_id == "world"
        assert list(cows[9].eye) == pytest.approx([0.1, 0.2, 9.0])
        assert {type(found) for found in headers} == {
            Header
        }  # the installed class: its definition is the same
        assert headers[3].stamp.sec == 3
        assert [(one.topic, one.received) for one in bag][:3] == [
            ("/cows", 0),
            ("/headers", 3),
            ("/cows", 10),
        ]
        [first] = bag.recorded("/cows", end=1)
        assert first.data == STORE.serialize_cdr(cow(0), "farm_msgs/msg/Cow")  # not as it was compressed
        assert first.message.name == "cow 0"
        assert bag.topics["/cows"].type_hash == STORE.hash_rihs01("farm_msgs/msg/Cow")
        assert (bag.start, bag.end, len(bag)) == (0, 193, 40)
        (qos,) = bag.topics["/cows"].qos
        assert (qos.depth, qos.reliability, qos.durability) == (7, "best_effort", "transient_local")
        assert (qos.deadline, qos.lifespan) == (100_000_000, None)


def test_a_file_of_a_folder_by_itself(tmp_path: Path) -> None:
    for storage, name in ((StoragePlugin.SQLITE3, "a.db3"), (StoragePlugin.MCAP, "b.mcap")):
        folder = written_by_rosbags(tmp_path / Path(name).stem, 9, storage)
        with Bag(folder / name, strict=True) as bag:
            assert [found.name for found in bag["/cows"].between(50, 80)] == ["cow 5", "cow 6", "cow 7"]
            assert bag["/cows"].column("eye").shape == (20, 3)


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_what_rosbags_reads_of_ours(tmp_path: Path, compression: Any) -> None:
    from geometry_msgs.msg import Point, Point32, Polygon
    from sensor_msgs.msg import JointState

    path = tmp_path / "ours"
    with Recorder(path, compression=compression, chunk_size=1000, split_size=4000) as recorder:
        for index in range(50):
            joints = JointState(name=["a", "b"], position=[0.1, 0.1 * index])
            recorder.write("/joints", joints, received=100 + index)
            polygon = Polygon(points=[Point32(x=0.1 * number) for number in range(index % 3)])
            recorder.write("/polygons", polygon, received=100 + index)
        recorder.add_topic("/points", Point)
    with AnyReader([path]) as reader:
        hashes = {each.topic: each.digest for each in reader.connections}
        assert hashes == {
            "/joints": JointState.__type_hash__,
            "/polygons": Polygon.__type_hash__,
            "/points": Point.__type_hash__,
        }
        assert (reader.message_count, reader.start_time, reader.end_time) == (100, 100, 150)
        found = [
            (each.topic, time, reader.deserialize(data, each.msgtype))
            for each, time, data in reader.messages()
        ]
    joints = [(time, message.position.tolist()) for topic, time, message in found if topic == "/joints"]
    assert joints == [(100 + index, [0.1, 0.1 * index]) for index in range(50)]
    assert [len(message.points) for topic, _, message in found if topic == "/polygons"] == [
        n % 3 for n in range(50)
    ]
