"""Fields of recorded messages as numpy arrays."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from ifgen_runtime.bag import Bag, BagError, Recorder

from .conftest import GENERATED

COUNT = 5000  # more than one block


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Any:
    from builtin_interfaces.msg import Duration, Time
    from geometry_msgs.msg import Point, Point32, Polygon, Pose, PoseStamped
    from sensor_msgs.msg import Imu, JointState, PointField
    from std_msgs.msg import Bool, Header
    from test_msgs.msg import Arrays, Builtins, UnboundedSequences

    path = tmp_path_factory.mktemp("bags") / "run.mcap"
    with Recorder(path, compression="none") as recorder:
        for index in range(COUNT):
            header = Header(stamp=Time(sec=index, nanosec=index + 1), frame_id=f"frame {index % 3}")
            pose = Pose(position=Point(x=0.1 * index))
            recorder.write(
                "/pose", PoseStamped(header=header, pose=pose), received=index, published=index // 2
            )
        for index in range(3):
            recorder.write(
                "/joints", JointState(position=[0.1, 0.2 * index], name=["a", "b"]), received=index
            )
            recorder.write(
                "/ragged", JointState(position=[0.5] * index, velocity=[0.1 * index]), received=index
            )
            points = [Point32(x=float(index)), Point32(y=0.5)]
            recorder.write("/polygon", Polygon(points=points), received=index)
            recorder.write("/bool", Bool(data=index == 1), received=index)
            lists = UnboundedSequences(
                bool_values=[True, False], byte_values=[b"\1", b"\xff"], char_values=[7]
            )
            recorder.write("/lists", lists, received=index)
            duration = Builtins(duration_value=Duration(sec=-1, nanosec=500_000_000))
            recorder.write("/duration", duration, received=index)
            recorder.write("/imu", Imu(orientation_covariance=[0.1 * index] * 9), received=index)
            recorder.write("/field", PointField(datatype=index), received=index)
            recorder.write("/arrays", Arrays(string_values=["a", "b", "c"]), received=index)
        recorder.add_topic("/silent", JointState)
    with Bag(path, strict=True) as opened:
        yield opened


def test_single_values(bag: Any) -> None:
    x = bag["/pose"].column("pose.position.x")
    assert (x.dtype, x.shape) == (np.float64, (COUNT,))
    assert x.tolist() == [0.1 * index for index in range(COUNT)]
    assert bag["/pose"].column("header.stamp").tolist() == [n * 10**9 + n + 1 for n in range(COUNT)]
    assert bag["/pose"].column("header.stamp").dtype == np.int64
    assert bag["/pose"].column("header.stamp.sec").dtype == np.int32
    assert bag["/duration"].column("duration_value").tolist() == [-500_000_000] * 3
    assert bag["/pose"].column("header.frame_id")[:4].tolist() == ["frame 0", "frame 1", "frame 2", "frame 0"]
    assert bag["/bool"].column("data").tolist() == [False, True, False]
    assert bag["/bool"].column("data").dtype == np.bool_
    assert bag["/field"].column("datatype").tolist() == [0, 1, 2]
    assert bag["/pose"].received().tolist() == list(range(COUNT))
    assert bag["/pose"].published()[-1] == (COUNT - 1) // 2
    part = bag["/pose"].between(10, 12).columns("header.stamp.sec", "pose.position.x")
    assert {path: values.tolist() for path, values in part.items()} == {
        "header.stamp.sec": [10, 11],
        "pose.position.x": [1.0, 0.1 * 11],
    }


def test_sequences_and_arrays(bag: Any) -> None:
    position = bag["/joints"].column("position")
    assert position.tolist() == [[0.1, 0.2 * index] for index in range(3)]
    assert bag["/joints"].column("position[1]").tolist() == [0.2 * index for index in range(3)]
    assert bag["/joints"].column("name").tolist() == [["a", "b"]] * 3
    assert bag["/imu"].column("orientation_covariance").shape == (3, 9)
    assert bag["/imu"].column("orientation_covariance[8]").tolist() == [0.1 * index for index in range(3)]
    assert bag["/polygon"].column("points[0].x").tolist() == [0.0, 1.0, 2.0]
    assert bag["/lists"].column("bool_values").tolist() == [[True, False]] * 3
    assert bag["/lists"].column("byte_values").tolist() == [[1, 255]] * 3
    assert bag["/lists"].column("byte_values[1]").tolist() == [255] * 3
    assert bag["/lists"].column("char_values").tolist() == [[7]] * 3
    assert bag["/arrays"].column("string_values").tolist() == [["a", "b", "c"]] * 3
    ragged = bag["/ragged"].column("position", ragged=True)
    assert [values.tolist() for values in ragged] == [[], [0.5], [0.5, 0.5]]
    assert bag["/silent"].column("position").shape == (0, 0)
    assert bag["/silent"].column("header.stamp").shape == (0,)


@pytest.mark.parametrize(
    ("topic", "path", "says"),
    [
        (
            "/ragged",
            "position",
            "position has 0 values in the first message and 1 in message 1: ask for ragged=True, or for one of them, as position[0]",
        ),
        ("/ragged", "position[1]", "position[1] is beyond the end of the sequence in message 0"),
        (
            "/joints",
            "speed",
            "sensor_msgs/msg/JointState has no field 'speed': it has header, name, position, velocity, effort",
        ),
        ("/pose", "pose.position.w", "geometry_msgs/msg/Point has no field 'w': it has x, y, z"),
        ("/pose", "pose.position.x.y", "pose.position.x has no field 'y': it is a value without fields"),
        (
            "/pose",
            "pose.position",
            "pose.position is a message, not a number or a text: name a field of it, as pose.position.x",
        ),
        (
            "/polygon",
            "points",
            "points is a sequence of messages, not a number or a text: name a field of it, as points[0].x",
        ),
        ("/polygon", "points.x", "points is a sequence: name one element, as points[0].x"),
        ("/pose", "pose[0]", "pose is no sequence: pose[0] has no meaning"),
        (
            "/imu",
            "orientation_covariance[9]",
            "orientation_covariance has 9 elements: orientation_covariance[9] is beyond its end",
        ),
        ("/pose", "pose..x", "'pose..x' is no path of a field, such as pose.position.x or position[0]"),
        ("/pose", "__class__", "'__class__' is no path of a field, such as pose.position.x or position[0]"),
    ],
)
def test_columns_that_make_no_sense(bag: Any, topic: str, path: str, says: str) -> None:
    with pytest.raises(BagError, match=re.escape(says)):
        bag[topic].column(path)


def test_a_table_needs_pandas(bag: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(BagError, match="the library pandas: pip install pandas"):
        bag["/pose"].frame()


def test_a_table(bag: Any) -> None:
    pytest.importorskip("pandas")
    table = bag["/pose"].between(0, 2).frame()
    assert list(table.columns)[:3] == ["header.stamp", "header.frame_id", "pose.position.x"]
    assert table["pose.position.x"].tolist() == [0.0, 0.1]
    assert table.index.name == "received"
    assert [values.tolist() for values in bag["/ragged"].frame("position")["position"]] == [
        [],
        [0.5],
        [0.5, 0.5],
    ]


def test_reading_without_columns_loads_neither_numpy_nor_a_compressor(bag: Any) -> None:
    program = (
        "import sys; sys.path.insert(0, sys.argv[2]); from ifgen_runtime.bag import Bag; bag = Bag(sys.argv[1]); next(iter(bag['/pose']))\n"
        "print([name for name in ('numpy', 'pandas', 'zstandard', 'lz4', 'mcap', 'sqlite3', 'yaml', 'importlib.metadata') if name in sys.modules])"
    )
    command = [sys.executable, "-c", program, str(bag.path), str(GENERATED)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.stderr, done.stdout) == ("", "[]\n")


def test_views(bag: Any) -> None:
    with Bag(bag.path, views=True) as viewing:
        message = next(iter(viewing["/joints"]))
        assert isinstance(message.position, np.ndarray)
        assert not message.position.flags.owndata
        assert viewing["/joints"].column("position").tolist() == bag["/joints"].column("position").tolist()
        assert list(viewing["/pose"]) == list(bag["/pose"])
