"""Point clouds: records at computed places by `struct`, organised and not, both byte orders, both ways."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime import ConversionError, deserialize, serialize
from ifgen_runtime.numpy import from_point_array, point_array, xyz_array

RANDOM = np.random.default_rng(3)
CHARACTERS = dict(zip(range(1, 9), "bBhHiIfd", strict=True))  # PointField.INT8 to FLOAT64
LIDAR = np.dtype(
    {
        "names": ["x", "y", "z", "intensity", "ring", "normal"],
        "formats": ["f4", "f4", "f4", "f4", "u2", ("f4", (3,))],
        "offsets": [0, 4, 8, 16, 20, 24],
        "itemsize": 40,
    }
)


def fields(msg: SimpleNamespace, *rows: tuple[str, int, int, int]) -> list[Any]:
    return [msg.PointField(name=name, offset=at, datatype=code, count=n) for name, at, code, n in rows]


@pytest.mark.parametrize("is_bigendian", [False, True])
@pytest.mark.parametrize(("height", "padding"), [(1, 0), (3, 0), (3, 7)])
def test_records_are_where_the_fields_say(
    msg: SimpleNamespace, height: int, padding: int, is_bigendian: bool
) -> None:
    width, point_step = 4, 61
    rows = [(f"f{code}", 7 * code - 6, code, 1) for code in CHARACTERS] + [("many", 3, 4, 2)]
    row_step = width * point_step + padding
    data = RANDOM.integers(0, 64, height * row_step, np.uint8).tobytes()
    cloud = msg.PointCloud2(
        height=height, width=width, fields=fields(msg, *rows), is_bigendian=is_bigendian, data=data
    )
    cloud.point_step, cloud.row_step = point_step, row_step
    points = point_array(cloud)
    assert points.shape == ((width,) if height == 1 else (height, width))
    assert points.dtype.names == tuple(name for name, *_ in rows)
    for row, column in np.ndindex(height, width):
        record = points.reshape(height, width)[row, column]
        for name, offset, code, count in rows:
            form = f"{'<>'[is_bigendian]}{count}{CHARACTERS[code]}"
            numbers = struct.unpack_from(form, data, row * row_step + column * point_step + offset)
            assert np.ravel(record[name]).tolist() == list(numbers), name
    points["f8"].flat[-1] = 0.1
    place = (height - 1) * row_step + (width - 1) * point_step + 50
    assert struct.unpack_from("<>"[is_bigendian] + "d", cloud.data, place) == (0.1,)


@pytest.mark.parametrize("shape", [(5,), (2, 5), (0,), (0, 5)])
def test_structured_points_back(msg: SimpleNamespace, shape: tuple[int, ...]) -> None:
    points = np.zeros(shape, LIDAR)
    for name in LIDAR.names or ():
        points[name] = RANDOM.integers(0, 9, points[name].shape) + 0.1
    cloud = from_point_array(msg.PointCloud2, points, header=msg.Header(frame_id="lidar"))
    assert (cloud.height, cloud.width) == (1, *shape)[-2:]
    assert (cloud.point_step, cloud.row_step, cloud.is_bigendian) == (40, 40 * shape[-1], False)
    assert cloud.header.frame_id == "lidar"
    assert [(f.name, f.offset, f.datatype, f.count) for f in cloud.fields] == [
        *(("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("intensity", 16, 7, 1)),
        *(("ring", 20, 4, 1), ("normal", 24, 7, 3)),
    ]
    assert bytes(cloud.data) == points.tobytes()
    assert type(cloud.fields[0]) is msg.PointField
    if shape[0]:
        np.testing.assert_array_equal(point_array(cloud), points)
        np.testing.assert_array_equal(xyz_array(cloud), np.stack([points[name] for name in "xyz"], axis=-1))
    assert serialize(deserialize(serialize(cloud), msg.PointCloud2)) == serialize(cloud)


@pytest.mark.parametrize("dtype", ["f4", "f8", ">f4"])
@pytest.mark.parametrize("shape", [(5,), (2, 5)])
def test_plain_coordinates_back(msg: SimpleNamespace, shape: tuple[int, ...], dtype: str) -> None:
    coordinates = RANDOM.standard_normal((*shape, 3)).astype(dtype)
    cloud = from_point_array(msg.PointCloud2, coordinates[::-1])
    assert [field.name for field in cloud.fields] == ["x", "y", "z"]
    view = xyz_array(cloud)
    np.testing.assert_array_equal(view, coordinates[::-1])
    assert view.dtype == np.dtype(dtype).newbyteorder("<")
    view[..., 2] = 0.1
    assert np.ravel(point_array(cloud)["z"]).tolist() == [np.asarray(0.1, dtype).item()] * (
        len(cloud.data) // cloud.point_step
    )


def test_big_endian_records_with_padding_become_little_endian_without_what_was_in_memory(
    msg: SimpleNamespace,
) -> None:
    dtype = np.dtype({"names": ["x"], "formats": [">f4"], "offsets": [2], "itemsize": 8})
    points = np.frombuffer(b"\xff" * 16, dtype).copy()
    points["x"] = 0.1
    cloud = from_point_array(msg.PointCloud2, points)
    assert bytes(cloud.data) == (bytes(2) + struct.pack("<f", 0.1) + bytes(2)) * 2


def test_a_cloud_is_dense_if_all_coordinates_are_finite(msg: SimpleNamespace) -> None:
    coordinates = np.full((4, 3), 0.1)
    assert from_point_array(msg.PointCloud2, coordinates).is_dense is True
    coordinates[3, 2] = np.nan
    assert from_point_array(msg.PointCloud2, coordinates).is_dense is False
    assert from_point_array(msg.PointCloud2, coordinates, is_dense=True).is_dense is True
    points = np.zeros(2, [("x", "i4"), ("xy", "f4"), ("intensity", "f4")])
    points["intensity"] = points["xy"] = np.inf
    assert from_point_array(msg.PointCloud2, points).is_dense is True


def test_what_drivers_and_pcl_publish(msg: SimpleNamespace) -> None:
    """Padding fields that share a name, a count of 0, a row_step of 0 for one row, fields that overlap."""
    rows = [
        ("x", 0, 7, 0),
        ("_", 4, 2, 4),
        ("rgb", 8, 7, 1),
        ("_", 12, 2, 4),
        ("", 0, 99, 1),
        ("rgba", 8, 6, 1),
    ]
    data = struct.pack("<f4xI4x", 0.1, 0x3F800000)
    cloud = msg.PointCloud2(
        height=1, width=1, fields=fields(msg, *rows[:4], rows[5]), point_step=16, data=data
    )
    points = point_array(cloud)
    assert points.dtype.names == ("x", "rgb", "rgba")
    assert points[0].tolist() == (struct.unpack("<f", data[:4])[0], 1.0, 0x3F800000)
    assert point_array(msg.PointCloud2()).shape == (0,)
    assert point_array(msg.PointCloud2(height=2, width=0)).shape == (2, 0)


XYZ = [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1)]


@pytest.mark.parametrize(
    ("change", "rows", "error"),
    [
        ({"point_step": 0}, [], "point_step: expected at least 1, got 0"),
        ({"point_step": 11}, XYZ, "fields[2].offset: 'z' ends at byte 12, beyond point_step 11"),
        ({"row_step": 23}, XYZ, "row_step: expected at least 24 for 2 points of 12 bytes, got 23"),
        ({"row_step": 25}, XYZ, "data: expected at least 49 bytes, got 48"),
        (
            {"width": 3, "height": 1},
            [("x", 0, 7, 1)] * 2,
            "fields[1].name: expected a name of its own, got 'x'",
        ),
        ({}, [("x", 0, 0, 1)], "fields[0].datatype: expected 1 (INT8) to 8 (FLOAT64), got 0"),
        (
            {},
            [("x", 2**32 - 1, 1, 2**32 - 1)],
            "fields[0].offset: 'x' ends at byte 8589934590, beyond point_step 12",
        ),
        ({"point_step": 2**31}, XYZ, "point_step: expected an integer in [0, 2147483647], got 2147483648"),
        ({"_data": None}, XYZ, "data: expected a contiguous array of uint8, got None"),
    ],
)
def test_a_cloud_that_contradicts_itself(
    msg: SimpleNamespace, change: dict[str, Any], rows: list[tuple[str, int, int, int]], error: str
) -> None:
    cloud = from_point_array(msg.PointCloud2, np.zeros((2, 2, 3), np.float32))
    cloud.fields = fields(msg, *rows)
    for name, value in change.items():
        setattr(cloud, name, value)
    with pytest.raises(ConversionError) as raised:
        point_array(cloud)
    assert str(raised.value) == f"PointCloud2.{error}"


@pytest.mark.parametrize(
    ("rows", "error"),
    [
        ([("y", 4, 7, 1), ("z", 8, 7, 1)], r"expected x, y and z, got \['y', 'z'\]$"),
        ([], r"expected x, y and z, got \[\]$"),
        (
            [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 4, 8, 1)],
            "x, y and z need one float type and equal distances",
        ),
        (
            [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 6, 7, 1)],
            "x, y and z need one float type and equal distances",
        ),
        (
            [("x", 0, 6, 1), ("y", 4, 6, 1), ("z", 8, 6, 1)],
            "x, y and z need one float type and equal distances",
        ),
        (
            [("x", 0, 7, 3), ("y", 0, 7, 3), ("z", 0, 7, 3)],
            "x, y and z need one float type and equal distances",
        ),
        (
            [("x", 0, 7, 1), ("y", 0, 7, 1), ("z", 0, 7, 1)],
            "x, y and z need one float type and equal distances",
        ),
        (
            [("x", 4, 7, 1), ("y", 2, 7, 1), ("z", 0, 7, 1)],
            "x, y and z need one float type and equal distances",
        ),
    ],
)
def test_coordinates_that_no_view_covers(
    msg: SimpleNamespace, rows: list[tuple[str, int, int, int]], error: str
) -> None:
    cloud = from_point_array(msg.PointCloud2, np.zeros((2, 3), np.float32))
    cloud.fields = fields(msg, *rows)
    with pytest.raises(ConversionError, match=rf"^PointCloud2\.fields: {error}"):
        xyz_array(cloud)


def test_coordinates_in_any_order(msg: SimpleNamespace) -> None:
    points = np.zeros(2, [("z", "f4"), ("y", "f4"), ("x", "f4")])
    points["x"], points["z"] = 0.5, 2
    assert xyz_array(from_point_array(msg.PointCloud2, points)).tolist() == [[0.5, 0, 2]] * 2


@pytest.mark.parametrize(
    ("points", "error"),
    [
        (np.zeros((2, 4)), "data: expected a structured array of shape"),
        (np.zeros((2, 3), np.float16), "data: expected a structured array of shape"),
        (np.zeros((2, 2, 2), LIDAR), "data: expected a structured array of shape"),
        (np.zeros((), LIDAR), "data: expected a structured array of shape"),
        (np.zeros(2, []), "data: expected a structured array of shape"),
        (np.zeros(2, [("x", "f4"), ("t", "i8")]), "fields[1].datatype: 't' is int64; a point can hold"),
        (np.zeros(2, [("a", [("b", "f4")])]), "fields[0].datatype: 'a' is [('b', '<f4')]; a point can hold"),
        (np.zeros(2, [("o", object)]), "fields[0].datatype: 'o' is object; a point can hold"),
    ],
)
def test_points_that_no_cloud_can_hold(msg: SimpleNamespace, points: Any, error: str) -> None:
    with pytest.raises(ConversionError) as raised:
        from_point_array(msg.PointCloud2, points)
    assert str(raised.value).startswith(f"PointCloud2.{error}")
