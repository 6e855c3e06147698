"""as_array: a view where one is possible, and a TypeError where none is."""

from __future__ import annotations

from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime.numpy import as_array


@pytest.mark.parametrize(
    ("name", "field", "dtype"),
    [
        ("Image", "data", np.uint8),
        ("OccupancyGrid", "data", np.int8),
        ("LaserScan", "ranges", np.float32),
        ("JointState", "position", np.float64),
        ("Imu", "orientation_covariance", np.float64),
        ("CameraInfo", "k", np.float64),
    ],
)
def test_a_view_of_a_field_writes_to_it(msg: SimpleNamespace, name: str, field: str, dtype: Any) -> None:
    message = getattr(msg, name)()
    if not len(getattr(message, field)):
        setattr(message, field, [3, 4, 5])
    view = as_array(getattr(message, field))
    assert view.dtype == dtype
    assert view.shape == (len(getattr(message, field)),)
    view[1] = 7
    assert getattr(message, field)[1] == 7


@pytest.mark.parametrize("typecode", "bBhHiIlLqQfd")
def test_every_array_of_numbers_has_its_dtype(typecode: str) -> None:
    numbers = array(typecode, [1, 2])
    assert as_array(numbers).dtype == np.dtype(typecode)
    assert as_array(array(typecode)).shape == (0,)
    assert as_array(numbers).tolist() == [1, 2]


def test_other_memory() -> None:
    assert as_array(b"ab").tolist() == [97, 98]
    assert not as_array(b"ab").flags.writeable
    data = bytearray(b"ab")
    as_array(data)[0] = 99
    assert data == b"cb"
    assert as_array(memoryview(data).cast("H")).dtype == np.uint16
    numbers = np.zeros((3, 3))
    assert as_array(numbers) is numbers


def test_a_sequence_keeps_its_length_while_there_is_a_view(msg: SimpleNamespace) -> None:
    scan = msg.LaserScan(ranges=[1.0, 0.1])
    view = as_array(scan.ranges)
    with pytest.raises(BufferError):
        scan.ranges.append(2.0)
    del view
    scan.ranges.append(2.0)


def test_what_is_a_list_or_no_field_is_refused(msg: SimpleNamespace) -> None:
    for field in ([True], ["a"], [b"a"]):
        with pytest.raises(
            TypeError, match=r"^as_array cannot view list without a copy: numpy\.array\(field\) copies"
        ):
            as_array(field)  # type: ignore[call-overload]
    with pytest.raises(
        TypeError, match="cannot view sensor_msgs/msg/Image without a copy: pass a field of numbers"
    ):
        as_array(msg.Image())
