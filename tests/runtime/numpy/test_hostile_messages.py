"""Messages whose sizes lie: a view inside the data or a ConversionError, at once and without memory for it."""

from __future__ import annotations

import tracemalloc
from types import SimpleNamespace
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import ConversionError
from ifgen_runtime.numpy import grid_array, image_array, image_planes, point_array, scan_points, xyz_array

HUGE = [0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 0x40000001, 0x10001, 0x10000, 0xFFFF]
SIZES = st.integers(0, 9) | st.integers(0, 70) | st.sampled_from(HUGE)
ODD: list[Any] = [-1, 2**32, 2**64, None, "1", 0.5, [], b"\0"]
VALUES = st.one_of(*[SIZES] * 12, st.sampled_from(ODD))
DATA = st.binary(max_size=400) | st.integers(0, 400).map(bytes)
ENCODINGS = [
    *("mono8", "rgb8", "bgra16", "bayer_gbrg16", "yuv422", "nv12", "nv21", "nv24", "8UC1", "16SC2", "32FC3"),
    *("64FC4", "64FC512", "64FC513", "8UC0", "8UC99999999999999999999", "8UC", "", "rgb", None),
]
LIMIT = 2_000_000  # bytes


def bounds(view: np.ndarray) -> tuple[int, int]:
    """The addresses of the first byte of a view, and of the byte after its last."""
    reach = [(size - 1) * stride for size, stride in zip(view.shape, view.strides, strict=True)]
    first = view.__array_interface__["data"][0]
    return first + sum(min(r, 0) for r in reach), first + sum(max(r, 0) for r in reach) + view.itemsize


def judged(view_of: Any, message: Any, data: bytes) -> None:
    """Views are inside the data and cover no byte twice, so that a copy of one is no larger than the message."""
    try:
        found = view_of(message)
    except ConversionError as error:
        assert error.path.startswith(message.__class__.__name__ + ".")
        assert len(str(error)) < 700
        return
    memory = np.frombuffer(message.data, np.uint8)
    low = memory.__array_interface__["data"][0]
    for view in found if isinstance(found, tuple) else [found]:
        assert view.nbytes <= len(data)
        if view.size and view.dtype.itemsize:
            first, end = bounds(view)
            assert low <= first < end <= low + len(data)
            assert np.shares_memory(view, memory)
            assert view.tobytes() is not None  # reads all of it


def limited(call: Any, *arguments: Any) -> None:
    """Call it, and look at the memory that it took."""
    tracemalloc.start()
    try:
        call(*arguments)
        assert tracemalloc.get_traced_memory()[1] < LIMIT
    finally:
        tracemalloc.stop()


@settings(max_examples=250)
@given(
    values=st.fixed_dictionaries(dict.fromkeys(("height", "width", "is_bigendian", "step"), VALUES)),
    encoding=st.sampled_from(ENCODINGS) | st.text(max_size=30),
    data=DATA,
)
def test_images(msg: SimpleNamespace, values: dict[str, Any], encoding: Any, data: bytes) -> None:
    image = msg.Image(data=data)
    for name, value in (values | {"encoding": encoding}).items():
        setattr(image, name, value)
    for view_of in (image_array, image_planes):
        limited(judged, view_of, image, data)


@st.composite
def layouts(draw: Any) -> list[dict[str, Any]]:
    names = st.sampled_from(["x", "y", "z", "_", "", "intensity", "\0", "é"]) | st.sampled_from(
        [None, 3, "x" * 10**5]
    )
    types = st.sampled_from([1, 2, 3, 4, 5, 6, 7, 7, 7, 8, 0, 9, 255])
    rows = st.fixed_dictionaries(
        {"name": names, "offset": VALUES, "datatype": types | VALUES, "count": VALUES}
    )
    xyz = [{"name": n, "offset": o, "datatype": 7, "count": 1} for n, o in (("x", 0), ("y", 4), ("z", 8))]
    stacked = [{"name": n, "offset": 0, "datatype": 8, "count": 1} for n in "xyz"]
    return draw(st.lists(rows, max_size=5) | st.sampled_from([xyz, xyz[::-1], stacked]))


@settings(max_examples=300)
@given(
    values=st.fixed_dictionaries(dict.fromkeys(("height", "width", "point_step", "row_step"), VALUES)),
    layout=layouts(),
    is_bigendian=st.booleans(),
    data=DATA,
)
def test_point_clouds(
    msg: SimpleNamespace,
    values: dict[str, Any],
    layout: list[dict[str, Any]],
    is_bigendian: bool,
    data: bytes,
) -> None:
    cloud = msg.PointCloud2(data=data, is_bigendian=is_bigendian)
    for name, value in values.items():
        setattr(cloud, name, value)
    for row in layout:
        field = msg.PointField()
        for name, value in row.items():
            setattr(field, name, value)
        cloud.fields.append(field)
    for view_of in (point_array, xyz_array):
        limited(judged, view_of, cloud, data)


@settings(max_examples=200)
@given(height=VALUES, width=VALUES, data=DATA)
def test_grids(msg: SimpleNamespace, height: Any, width: Any, data: bytes) -> None:
    grid = msg.OccupancyGrid(data=np.frombuffer(data, np.int8).tolist())
    grid.info.height, grid.info.width = height, width
    limited(judged, grid_array, grid, data)


@settings(max_examples=200)
@given(
    numbers=st.lists(st.floats() | st.sampled_from([1e308, None, "1"]), min_size=4, max_size=4),
    ranges=st.lists(st.floats(width=32), max_size=20),
)
def test_scans(msg: SimpleNamespace, numbers: list[Any], ranges: list[float]) -> None:
    scan = msg.LaserScan(ranges=ranges)
    scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max = numbers
    try:
        points = scan_points(scan)
    except ConversionError as error:
        assert error.path.startswith("LaserScan.")
    else:
        assert points.shape == (len(ranges), 2)
