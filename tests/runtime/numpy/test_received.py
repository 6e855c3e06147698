"""The functions for images, clouds and scans on messages whose sequences show received bytes."""

from __future__ import annotations

import pickle
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.field_types import fields_of
from ifgen_runtime.numpy import as_array, from_point_array, from_ranges, image_array, scan_points, xyz_array
from ifgen_runtime.views import SequenceView


def received(message: Any) -> Any:
    """The message as somebody received it."""
    return deserialize(serialize(message), type(message), views=True)


def test_a_field_is_its_own_array(msg: SimpleNamespace) -> None:
    scan = received(msg.LaserScan(ranges=[0.1, 0.2]))
    assert as_array(scan.ranges) is scan.ranges


def test_pixels_are_read_only_until_the_image_is_written(msg: SimpleNamespace) -> None:
    image = received(msg.Image(height=2, width=2, encoding="mono8", step=2, data=[1, 2, 3, 4]))
    pixels = image_array(image)
    assert pixels.tolist() == [[1, 2], [3, 4]]
    with pytest.raises(ValueError, match="read-only"):
        pixels[0, 0] = 9
    image.data[0] = 9
    assert pixels[0, 0] == 1
    image_array(image)[1, 1] = 8
    assert image.data.tolist() == [9, 2, 3, 8]


def test_clouds_and_scans(msg: SimpleNamespace) -> None:
    points = np.arange(6, dtype=np.float32).reshape(2, 3) / 10
    assert np.array_equal(xyz_array(received(from_point_array(msg.PointCloud2, points))), points)
    scan = from_ranges(msg.LaserScan, [0.1, 2.5], angles=(0.0, 1.0), limits=(0.1, 9.0))
    assert np.array_equal(scan_points(received(scan)), scan_points(scan))


def test_a_scan_of_the_other_byte_order(msg: SimpleNamespace) -> None:
    scan = from_ranges(msg.LaserScan, [0.1, 2.5], angles=(0.0, 1.0), limits=(0.1, 9.0))
    assert [field.name for field in fields_of(msg.LaserScan)][-2:] == ["ranges", "intensities"]
    header = b"\0\0\0\0" + bytes(8) + (1).to_bytes(4, "big") + bytes(4)
    numbers = np.array([0, 1, 1, 0, 0, 0.1, 9], ">f4").tobytes()
    ranges = (2).to_bytes(4, "big") + np.array([0.1, 2.5], ">f4").tobytes()
    data = header + numbers + ranges + bytes(4)
    message = deserialize(data, msg.LaserScan, views=True)
    # Compiled classes would publish the memory of a field as it is.
    expected = array if not hasattr(msg.LaserScan, "__type_hash__") else np.ndarray
    assert isinstance(message.ranges, expected)
    assert np.asarray(message.ranges).dtype == np.dtype("f4" if expected is array else ">f4")
    assert np.array_equal(scan_points(message), scan_points(decode_any(data, msg.LaserScan)))
    assert np.array_equal(scan_points(message), scan_points(scan))


def test_a_pickle_owns_its_memory(msg: SimpleNamespace) -> None:
    scan = received(msg.LaserScan(ranges=[0.1, 0.2]))
    loaded = pickle.loads(pickle.dumps(scan))
    assert type(loaded.ranges) is SequenceView
    assert loaded.ranges.flags.owndata
    assert serialize(loaded) == serialize(scan)
