"""Point clouds as arrays: upstream's cases, round trips, and clouds that lie about themselves."""

from __future__ import annotations

import array
import random
import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.lib.recfunctions import structured_to_unstructured
from sensor_msgs.msg import PointCloud2, PointField
from sensor_msgs_py import numpy_compat, point_cloud2
from std_msgs.msg import Header

LITTLE = sys.byteorder == "little"
ROWS = [
    (0.0, 0.1, 0.2),
    (1.0, 1.1, 1.2),
    (2.0, 2.1, 2.2),
    (3.0, 3.1, 3.2),
    (4.0, np.nan, 4.2),
    (5.0, 5.1, 5.2),
]
POINTS = np.array(ROWS, dtype=np.float32)
TYPES = {
    PointField.INT8: "i1",
    PointField.UINT8: "u1",
    PointField.INT16: "i2",
    PointField.UINT16: "u2",
    PointField.INT32: "i4",
    PointField.UINT32: "u4",
    PointField.FLOAT32: "f4",
    PointField.FLOAT64: "f8",
}


def field(name: str, offset: int, datatype: int = PointField.FLOAT32, count: int = 1) -> PointField:
    return PointField(name=name, offset=offset, datatype=datatype, count=count)


XYZ = [field("x", 0), field("y", 4), field("z", 8)]


def cloud(
    data: bytes, fields: list[PointField], point_step: int, width: int, height: int = 1, **others: Any
) -> PointCloud2:
    made = PointCloud2(
        header=Header(frame_id="frame"),
        height=height,
        width=width,
        is_dense=False,
        is_bigendian=not LITTLE,
        fields=fields,
        point_step=point_step,
        row_step=point_step * width,
    )
    made.data = array.array("B", data)
    for name, value in others.items():
        setattr(made, name, value)
    return made


PLAIN = cloud(POINTS.tobytes(), XYZ, 12, 6)
ORGANISED = cloud(POINTS.tobytes(), XYZ, 12, width=2, height=3)
MIXED = np.array(list(map(tuple, POINTS)), dtype=[("a", "f4"), ("b", "f8"), ("c", "u1")])
MIXED_FIELDS = [field("a", 0), field("b", 4, PointField.FLOAT64), field("c", 12, PointField.UINT8)]


def same(one: Any, other: Any) -> bool:
    return bool(np.array_equal(np.asarray(one), np.asarray(other), equal_nan=True))


def test_points_with_all_fields_or_some() -> None:
    points = point_cloud2.read_points(PLAIN)
    assert points.dtype == np.dtype([("x", "f4"), ("y", "f4"), ("z", "f4")])
    assert same(structured_to_unstructured(points), POINTS)
    some = point_cloud2.read_points(PLAIN, field_names=["z", "x"])
    assert some.dtype.names == ("z", "x")
    assert same(structured_to_unstructured(some), POINTS[:, [2, 0]])
    assert same(point_cloud2.read_points_numpy(PLAIN), POINTS)
    with pytest.raises(AssertionError, match="Requests field is not in the fields of the PointCloud!"):
        point_cloud2.read_points(PLAIN, ["intensity"])
    with pytest.raises(AssertionError, match=r"Cloud is not a sensor_msgs\.msg\.PointCloud2"):
        point_cloud2.read_points(POINTS)


def test_points_without_nans_and_at_indices() -> None:
    complete = POINTS[~np.isnan(POINTS).any(axis=1)]
    assert same(point_cloud2.read_points_numpy(PLAIN, skip_nans=True), complete)
    assert same(point_cloud2.read_points_numpy(PLAIN, ("x", "z"), skip_nans=True), POINTS[:, [0, 2]])
    dense = cloud(POINTS.tobytes(), XYZ, 12, 6, is_dense=True)
    assert same(point_cloud2.read_points_numpy(dense, skip_nans=True), POINTS)
    for indices in ([0, 2], np.array([0, 2]), (number for number in (0, 2))):
        assert same(point_cloud2.read_points_numpy(PLAIN, uvs=indices), POINTS[[0, 2]])
    assert same(point_cloud2.read_points_numpy(PLAIN, skip_nans=True, uvs=[4]), complete[[4]])
    counts = cloud(b"\x01\x02", [field("n", 0, PointField.UINT8)], 1, 2)
    assert point_cloud2.read_points_numpy(counts, skip_nans=True).tolist() == [[1], [2]]


def test_points_as_named_tuples() -> None:
    found = point_cloud2.read_points_list(PLAIN, skip_nans=True, uvs=[1])
    assert (type(found[0]).__name__, found[0]._fields) == ("Point", ("x", "y", "z"))
    assert found[0].y == np.float32(1.1)
    assert [point._fields for point in point_cloud2.read_points_list(PLAIN, ["z"], uvs=[0])] == [("z",)]
    three = cloud(POINTS.tobytes(), [field("x", 0, count=3)], 12, 6)
    assert point_cloud2.read_points_list(three)[3] == tuple(POINTS[3])


def test_organised_clouds() -> None:
    assert same(point_cloud2.read_points_numpy(ORGANISED), POINTS)
    grid = point_cloud2.read_points(ORGANISED, reshape_organized_cloud=True)
    assert grid.shape == (2, 3)
    assert same(structured_to_unstructured(grid), POINTS.reshape(2, 3, -1))
    assert point_cloud2.read_points(PLAIN, reshape_organized_cloud=True).shape == (6,)
    made = point_cloud2.create_cloud_xyz32(Header(frame_id="frame"), POINTS.reshape(2, 3, -1))
    assert made == ORGANISED
    with pytest.raises(AssertionError, match="Too many dimensions for organized cloud!"):
        point_cloud2.create_cloud_xyz32(Header(), POINTS.reshape(1, 2, 3, -1))


def test_fields_of_several_types_values_and_names() -> None:
    mixed = cloud(MIXED.tobytes(), MIXED_FIELDS, 13, 6)
    points = point_cloud2.read_points(mixed)
    assert points.dtype == MIXED.dtype
    assert all(same(points[name], MIXED[name]) for name in MIXED.dtype.names)
    with pytest.raises(AssertionError, match="All fields need to have the same datatype"):
        point_cloud2.read_points_numpy(mixed)
    with pytest.raises(AssertionError, match="All fields need to have the same datatype"):
        point_cloud2.read_points_numpy(mixed, ("a", "b"))
    assert same(point_cloud2.read_points_numpy(mixed, ("b",))[:, 0], MIXED["b"])  # upstream compares with a
    three = cloud(POINTS.tobytes(), [field("x", 0, count=3)], 12, 6)
    assert point_cloud2.read_points(three).dtype.names == ("x_0", "x_1", "x_2")
    assert same(point_cloud2.read_points_numpy(three), POINTS)
    assert point_cloud2.create_cloud(Header(frame_id="frame"), three.fields, POINTS) == three
    nameless = point_cloud2.dtype_from_fields([field("x", 0), field("", 4), field("", 8, count=2)])
    assert nameless.names == ("x", "unnamed_field_1", "unnamed_field_2_0", "unnamed_field_2_1")
    assert nameless == np.dtype({"names": nameless.names, "formats": ["f4"] * 4, "offsets": [0, 4, 8, 12]})
    with pytest.raises(AssertionError, match="Duplicate field names are not allowed!"):
        point_cloud2.dtype_from_fields([field("x_1", 0), field("x", 4, count=2)])
    with pytest.raises(AssertionError, match="Can't process fields with count = 0"):
        point_cloud2.dtype_from_fields([field("x", 0, count=0)])


def test_clouds_are_made_of_rows_arrays_and_structured_arrays() -> None:
    header = Header(frame_id="frame")
    assert point_cloud2.create_cloud_xyz32(header, ROWS) == PLAIN
    assert point_cloud2.create_cloud_xyz32(header, (row for row in ROWS)) == PLAIN
    assert point_cloud2.create_cloud_xyz32(header, POINTS) == PLAIN
    assert point_cloud2.create_cloud_xyz32(header, POINTS[:, ::-1][:, ::-1]) == PLAIN  # not contiguous
    assert point_cloud2.create_cloud_xyz32(header, POINTS.astype("f8")) == PLAIN
    assert point_cloud2.create_cloud(header, (each for each in XYZ), ROWS) == PLAIN
    assert point_cloud2.create_cloud(header, MIXED_FIELDS, MIXED) == cloud(
        MIXED.tobytes(), MIXED_FIELDS, 13, 6
    )
    assert point_cloud2.create_cloud(Header(frame_id="other"), XYZ, ROWS) != PLAIN
    with pytest.raises(AssertionError, match="do not match for all fields"):
        point_cloud2.create_cloud(header, XYZ, MIXED)
    with pytest.raises(AssertionError, match="All fields need to have the same datatype"):
        point_cloud2.create_cloud(header, MIXED_FIELDS, POINTS)
    with pytest.raises(ValueError, match="the last axis should have 3 values"):
        point_cloud2.create_cloud(header, XYZ, POINTS[:, :2])
    empty = point_cloud2.create_cloud_xyz32(header, [])
    assert (empty.width, empty.height, len(empty.data), point_cloud2.read_points(empty).shape) == (
        0,
        1,
        0,
        (0,),
    )


def test_points_may_be_larger_than_their_fields() -> None:
    padded = np.zeros(
        6, {"names": ["x", "y", "z"], "formats": ["f4"] * 3, "offsets": [0, 4, 8], "itemsize": 20}
    )
    for name, column in zip("xyz", POINTS.T, strict=True):
        padded[name] = column
    header = Header(frame_id="frame")
    for made in (
        point_cloud2.create_cloud(header, XYZ, padded),  # upstream's since 5.9; 5.3 asks for point_step
        point_cloud2.create_cloud(header, XYZ, padded, 20),
        point_cloud2.create_cloud(header, XYZ, POINTS, 20),
        point_cloud2.create_cloud(header, XYZ, ROWS, point_step=20),
    ):
        assert made == cloud(padded.tobytes(), XYZ, 20, 6)
        assert same(point_cloud2.read_points_numpy(made), POINTS)
    with pytest.raises(AssertionError):
        point_cloud2.create_cloud(header, XYZ, padded, point_cloud2.dtype_from_fields(XYZ).itemsize)


def test_rows_may_be_longer_than_their_points() -> None:
    """Upstream reads such a cloud as if they were not."""
    rows = [POINTS[:3].tobytes(), POINTS[3:].tobytes()]
    padded = cloud(rows[0] + bytes(7) + rows[1], XYZ, 12, width=3, height=2, row_step=43)
    assert same(point_cloud2.read_points_numpy(padded), POINTS)
    unset = cloud(b"".join(rows), XYZ, 12, width=3, height=2, row_step=0)
    assert same(point_cloud2.read_points_numpy(unset), POINTS)


def test_points_in_the_byte_order_of_this_machine_are_a_view_and_others_a_copy() -> None:
    own = cloud(POINTS.tobytes(), XYZ, 12, 6)
    point_cloud2.read_points(own)["x"][0] = 7.5
    assert np.frombuffer(bytes(own.data), "f4")[0] == 7.5
    foreign = POINTS.byteswap().tobytes()
    other = cloud(foreign, XYZ, 12, 6, is_bigendian=LITTLE)
    for _ in range(2):  # upstream turns the bytes of the message around
        points = point_cloud2.read_points(other)
        assert points.dtype == np.dtype([("x", "f4"), ("y", "f4"), ("z", "f4")])
        assert same(structured_to_unstructured(points), POINTS)
        assert same(point_cloud2.read_points_numpy(other, ["y"]), POINTS[:, [1]])
    assert bytes(other.data) == foreign


@st.composite
def structured(draw: st.DrawFn) -> tuple[np.ndarray, list[PointField], bool]:
    """Points in either byte order, with gaps between values, and their fields."""
    order = draw(st.sampled_from("<>"))
    end, names, formats, fields = 0, [], [], []
    for index in range(draw(st.integers(1, 6))):
        datatype = draw(st.sampled_from(sorted(TYPES)))
        offset = end + draw(st.integers(0, 5))
        fields.append(field(f"f{index}", offset, datatype))
        names.append(f"f{index}")
        formats.append(order + TYPES[datatype])
        end = offset + np.dtype(TYPES[datatype]).itemsize
    layout = {
        "names": names,
        "formats": formats,
        "offsets": [each.offset for each in fields],
        "itemsize": end + draw(st.integers(0, 9)),
    }
    points = np.zeros(draw(st.integers(0, 9)), layout)
    for name in names:
        bits = draw(st.binary(min_size=8 * len(points), max_size=8 * len(points)))
        points[name] = np.frombuffer(bits, points[name].dtype)[: len(points)]
    return points, fields, order == ">"


@given(structured())
def test_structured_points_go_there_and_back(case: tuple[np.ndarray, list[PointField], bool]) -> None:
    points, fields, is_bigendian = case
    sent = cloud(points.tobytes(), fields, points.itemsize, len(points), is_bigendian=is_bigendian)
    found = point_cloud2.read_points(sent)
    assert found.dtype.isnative
    assert found.dtype == points.dtype.newbyteorder("=")
    assert all(same(found[name], points[name]) for name in points.dtype.names)
    again = point_cloud2.create_cloud(Header(), fields, found)
    assert again.point_step == points.itemsize
    back = point_cloud2.read_points(again)
    assert all(same(back[name], points[name]) for name in points.dtype.names)
    expected = np.zeros(len(points), found.dtype)
    expected[...] = points
    assert bytes(again.data) == expected.tobytes()  # 0 between values, not what was in memory


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"width": 7}, "a cloud of 7 x 1 points of 12 bytes needs 84 bytes of data, but has 72"),
        ({"width": 2**32 - 1, "height": 2**32 - 1}, "has rows of 51539607540 bytes, but its row_step is 72"),
        ({"height": 2}, "a cloud of 6 x 2 points of 12 bytes needs 144 bytes of data, but has 72"),
        ({"height": 2, "row_step": 2**32 - 1}, "needs 4294967367 bytes of data, but has 72"),
        ({"height": 2, "row_step": 71}, "has rows of 72 bytes, but its row_step is 71"),
        ({"point_step": 11}, "field 'z' ends at byte 12 of a point, which can have 11"),
        ({"point_step": 0}, "field 'x' ends at byte 4 of a point, which can have 0"),
        ({"point_step": 0, "fields": []}, "a cloud of 6 x 1 points of 0 bytes has no data to read"),
        ({"point_step": 2**32 - 1}, "a point of 4294967295 bytes is larger than numpy can have"),
        ({"data": array.array("B")}, "needs 72 bytes of data, but has 0"),
        ({"fields": [field("x", 2**32 - 4)]}, "field 'x' ends at byte 4294967296 of a point"),
        ({"fields": [field("x", 0, count=2**32 - 1)]}, "field 'x' ends at byte 17179869180 of a point"),
        ({"fields": [field("x", 0, datatype=9)]}, "field 'x' has datatype 9, which is none of PointField's"),
        (
            {"point_step": 2**31 - 1, "width": 0, "fields": [field("x", 0, PointField.UINT8, 2**31 - 1)]},
            "a point has more than 65536 values with field 'x'",
        ),
    ],
)
def test_clouds_that_lie(changes: dict[str, Any], reason: str) -> None:
    hostile = cloud(POINTS.tobytes(), XYZ, 12, 6)
    for name, value in changes.items():
        setattr(hostile, name, value)
    for read in (point_cloud2.read_points, point_cloud2.read_points_numpy, point_cloud2.read_points_list):
        with pytest.raises(ValueError) as caught:
            read(hostile, skip_nans=True)
        assert reason in str(caught.value)


def test_no_cloud_crashes_the_reader() -> None:
    draw = random.Random(3)
    numbers = [0, 1, 2, 3, 4, 5, 12, 13, 255, 2**16, 2**31 - 1, 2**31, 2**32 - 1]
    kinds = [*TYPES, 0, 9, 255]
    outcomes = {"read": 0, "refused": 0}
    for _ in range(3000):
        fields = [
            field(
                draw.choice(["", "x", "x_1", "1"]),
                draw.choice(numbers),
                draw.choice(kinds),
                draw.choice([1, 1, *numbers]),
            )
            for _ in range(draw.randrange(4))
        ]
        some = cloud(
            draw.randbytes(draw.randrange(80)),
            fields,
            draw.choice([4, 8, *numbers]),
            width=draw.choice([1, 2, *numbers]),
            height=draw.choice([1, 1, 2, *numbers]),
            is_bigendian=draw.random() < 0.5,
            row_step=draw.choice(numbers),
        )
        try:
            points = point_cloud2.read_points(some, skip_nans=True)
            assert len(points) * points.dtype.itemsize <= len(some.data)
            outcomes["read"] += 1
        except (ValueError, AssertionError):
            outcomes["refused"] += 1
    assert min(outcomes.values()) > 100


def test_functions_for_old_versions_of_numpy() -> None:
    points = numpy_compat.unstructured_to_structured(POINTS, point_cloud2.dtype_from_fields(XYZ))
    assert same(numpy_compat.structured_to_unstructured(points), POINTS)
