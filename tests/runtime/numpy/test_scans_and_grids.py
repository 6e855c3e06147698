"""Laser scans and occupancy grids."""

from __future__ import annotations

import math
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime import ConversionError
from ifgen_runtime.numpy import as_array, from_grid_array, from_ranges, grid_array, scan_angles, scan_points

NAN, INF = math.nan, math.inf


def test_points_are_what_the_rays_hit(msg: SimpleNamespace) -> None:
    scan = msg.LaserScan(angle_min=-0.1, angle_max=9.0, angle_increment=0.1, range_min=0.1, range_max=10.0)
    scan.ranges = [0.1, 2.0, 10.0, INF, -INF, NAN, 0.0999, 10.001]
    angles, points = scan_angles(scan), scan_points(scan)
    np.testing.assert_allclose(angles, [-0.1 + 0.1 * i for i in range(8)])
    assert points.shape == (8, 2)
    assert np.isnan(points[3:]).all()
    for angle, distance, (x, y) in zip(angles[:3], scan.ranges, points, strict=False):
        assert (x, y) == pytest.approx((distance * math.cos(angle), distance * math.sin(angle)), abs=1e-15)
    assert scan_points(msg.LaserScan()).shape == (0, 2)


def test_a_scan_of_ranges(msg: SimpleNamespace) -> None:
    ranges = [0.5, INF, NAN, 2]
    scan = from_ranges(
        msg.LaserScan,
        ranges,
        angles=(-1.5, 1.5),
        limits=(0.1, 30),
        intensities=np.arange(4),
        header=msg.Header(),
    )
    assert (scan.angle_min, scan.angle_max, scan.angle_increment) == (-1.5, 1.5, 1.0)
    assert (scan.range_min, scan.range_max) == (0.1, 30.0)
    assert bytes(scan.ranges) == struct.pack("<4f", *ranges)
    assert scan.intensities.tolist() == [0, 1, 2, 3]
    np.testing.assert_array_equal(as_array(scan.ranges), np.float32(ranges))
    assert scan_points(scan)[0] == pytest.approx((0.5 * math.cos(1.5), -0.5 * math.sin(1.5)))
    one = from_ranges(msg.LaserScan, np.array([0.5]), angles=(0.2, 0.2), limits=(0, 1))
    assert (one.angle_increment, len(one.intensities)) == (0.0, 0)


@pytest.mark.parametrize(
    ("ranges", "intensities", "error"),
    [
        ([[1.0]], None, r"ranges: expected numbers of shape \(n,\), got float64 and shape \(1, 1\)"),
        (["a"], None, r"ranges: expected numbers of shape \(n,\), got <U1 and shape \(1,\)"),
        ([1.0, 1e39], None, r"ranges\[1\]: 1e\+39 does not fit into a float32"),
        ([1.0, 2.0], [1], "intensities: expected 2 as for ranges, got 1"),
        ([1.0], [-1e39], r"intensities\[0\]: -1e\+39 does not fit into a float32"),
    ],
)
def test_ranges_that_no_scan_can_hold(
    msg: SimpleNamespace, ranges: Any, intensities: Any, error: str
) -> None:
    with pytest.raises(ConversionError, match=rf"^LaserScan\.{error}$"):
        from_ranges(msg.LaserScan, ranges, angles=(0, 1), limits=(0, 1), intensities=intensities)


@pytest.mark.parametrize("value", [NAN, INF, "1"])
@pytest.mark.parametrize("name", ["angle_min", "angle_increment", "range_max"])
def test_a_scan_without_directions(msg: SimpleNamespace, name: str, value: Any) -> None:
    scan = msg.LaserScan(ranges=[1.0])
    setattr(scan, name, value)
    with pytest.raises(
        ConversionError, match=rf"^LaserScan\.{name}: expected a finite number, got {value!r}$"
    ):
        scan_points(scan)


def test_a_grid_begins_at_its_origin(msg: SimpleNamespace) -> None:
    grid = msg.OccupancyGrid(data=[0, 1, 2, 100, -1, 5])
    grid.info.height, grid.info.width = 2, 3
    cells = grid_array(grid)
    assert cells.tolist() == [[0, 1, 2], [100, -1, 5]]
    assert cells.dtype == np.int8
    cells[1, 2] = 7
    assert grid.data[5] == 7
    assert grid_array(msg.OccupancyGrid()).shape == (0, 0)


@pytest.mark.parametrize("dtype", ["i1", "u1", "i8", ">i4"])
def test_a_grid_of_cells(msg: SimpleNamespace, dtype: str) -> None:
    cells = np.array([[0, 1, 2], [100, 127, 5]], dtype)[::-1]
    origin = msg.Pose(position=msg.Point(x=-5.5))
    grid = from_grid_array(
        msg.OccupancyGrid, cells, resolution=0.05, origin=origin, header=msg.Header(frame_id="map")
    )
    assert grid.data.tolist() == [100, 127, 5, 0, 1, 2]
    assert grid.data.typecode == "b"
    assert (grid.info.height, grid.info.width, grid.info.resolution) == (2, 3, 0.05)
    assert (grid.info.origin, grid.header.frame_id) == (origin, "map")
    np.testing.assert_array_equal(grid_array(grid), cells)
    assert from_grid_array(msg.OccupancyGrid, cells, resolution=1).info.origin == msg.Pose()


@pytest.mark.parametrize(
    ("cells", "resolution", "error"),
    [
        (
            np.zeros((2, 3)),
            0.1,
            r"data: expected integers of shape \(height, width\), got float64 and shape \(2, 3\)",
        ),
        (
            np.zeros(3, "i1"),
            0.1,
            r"data: expected integers of shape \(height, width\), got int8 and shape \(3,\)",
        ),
        (
            np.array([[0, 127], [128, 0]]),
            0.1,
            r"data\[2\]: expected an integer in \[-128, 127\], got 128 in row 1, column 0",
        ),
        (
            np.array([[0, -129]]),
            0.1,
            r"data\[1\]: expected an integer in \[-128, 127\], got -129 in row 0, column 1",
        ),
        (np.zeros((2, 3), "i1"), 0.0, r"info\.resolution: expected more than 0 m, got 0\.0"),
        (np.zeros((2, 3), "i1"), NAN, r"info\.resolution: expected more than 0 m, got nan"),
    ],
)
def test_cells_that_no_grid_can_hold(msg: SimpleNamespace, cells: Any, resolution: float, error: str) -> None:
    with pytest.raises(ConversionError, match=rf"^OccupancyGrid\.{error}$"):
        from_grid_array(msg.OccupancyGrid, cells, resolution=resolution)


def test_a_grid_that_contradicts_itself(msg: SimpleNamespace) -> None:
    grid = msg.OccupancyGrid(data=[0, 1])
    grid.info.height, grid.info.width = 2**32 - 1, 2**32 - 1
    with pytest.raises(
        ConversionError, match=r"^OccupancyGrid\.data: expected 4294967295 x 4294967295 = \d+ cells, got 2$"
    ):
        grid_array(grid)
    grid.info.width = -1
    with pytest.raises(
        ConversionError, match=r"^OccupancyGrid\.info\.width: expected an integer in .*, got -1$"
    ):
        grid_array(grid)
