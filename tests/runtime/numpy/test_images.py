"""Images: every encoding, both byte orders, padding, planes; against `struct` at computed places."""

from __future__ import annotations

import struct
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime import ConversionError
from ifgen_runtime.numpy import from_image_array, from_image_planes, image_array, image_planes

RANDOM = np.random.default_rng(7)
ENCODINGS = {  # those of sensor_msgs/image_encodings.hpp: format character and number of channels
    **{
        f"{name}8": ("B", channels)
        for name, channels in {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}.items()
    },
    **{
        f"{name}16": ("H", channels)
        for name, channels in {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}.items()
    },
    **{f"bayer_{name}8": ("B", 1) for name in ("rggb", "bggr", "gbrg", "grbg")},
    **{f"bayer_{name}16": ("H", 1) for name in ("rggb", "bggr", "gbrg", "grbg")},
    **dict.fromkeys(("uyvy", "yuv422", "yuyv", "yuv422_yuy2"), ("B", 2)),
    **{f"8UC{n}": ("B", n) for n in (1, 2, 3, 4, 5, 512)},
    **{f"8SC{n}": ("b", n) for n in (1, 2, 3, 4)},
    **{f"16UC{n}": ("H", n) for n in (1, 2, 3, 4)},
    **{f"16SC{n}": ("h", n) for n in (1, 2, 3, 4)},
    **{f"32SC{n}": ("i", n) for n in (1, 2, 3, 4)},
    **{f"32FC{n}": ("f", n) for n in (1, 2, 3, 4, 21)},
    **{f"64FC{n}": ("d", n) for n in (1, 2, 3, 4)},
    **{"8UC": ("B", 1), "32FC": ("f", 1), "32UC1": ("I", 1), "16FC1": ("e", 1), "64SC2": ("q", 2)},
}
ROWS, COLUMNS = 3, 5


@pytest.mark.parametrize("is_bigendian", [0, 1])
@pytest.mark.parametrize("padding", [0, 3])
def test_every_encoding(msg: SimpleNamespace, padding: int, is_bigendian: int) -> None:
    for encoding, (character, channels) in ENCODINGS.items():
        row = struct.Struct(f"{'<>'[is_bigendian]}{COLUMNS * channels}{character}")
        step = row.size + padding
        data = RANDOM.integers(0, 64, ROWS * step, np.uint8).tobytes()  # below 64, no NaN
        image = msg.Image(
            height=ROWS, width=COLUMNS, encoding=encoding, is_bigendian=is_bigendian, step=step, data=data
        )
        expected = [row.unpack_from(data, step * i) for i in range(ROWS)]
        pixels = image_array(image)
        assert pixels.shape == ((ROWS, COLUMNS) if channels == 1 else (ROWS, COLUMNS, channels))
        assert pixels.reshape(ROWS, -1).tolist() == [list(numbers) for numbers in expected], encoding
        pixels[1, 2] = 1
        place = step + 2 * row.size // COLUMNS
        written = struct.unpack_from(f"{'<>'[is_bigendian]}{channels}{character}", image.data, place)
        assert written == (1,) * channels


def test_every_encoding_back(msg: SimpleNamespace) -> None:
    header = msg.Header(frame_id="camera")
    for encoding, (character, channels) in ENCODINGS.items():
        numbers = RANDOM.integers(0, 100, (ROWS, COLUMNS, channels)).astype(np.dtype(character))
        image = from_image_array(msg.Image, numbers, encoding, header=header)
        assert (image.height, image.width, image.encoding, image.is_bigendian) == (ROWS, COLUMNS, encoding, 0)
        assert image.step == COLUMNS * channels * numbers.itemsize
        assert bytes(image.data) == struct.pack(f"<{numbers.size}{character}", *numbers.ravel().tolist())
        assert image.data.typecode == "B"
        assert image.header is header
        np.testing.assert_array_equal(image_array(image), numbers[:, :, 0] if channels == 1 else numbers)
    assert from_image_array(msg.Image, numbers, encoding).header == msg.Header()


@pytest.mark.parametrize(
    "pixels",
    [
        np.arange(24, dtype=">u2").reshape(4, 6)[::-1, ::2],
        np.asfortranarray(np.arange(12, dtype=np.uint16).reshape(4, 3)),
        np.broadcast_to(np.uint16(300), (4, 3)),
        np.arange(12, dtype=np.uint16).reshape(4, 3, 1),
    ],
)
def test_byte_order_and_strides_of_the_array_do_not_matter(msg: SimpleNamespace, pixels: Any) -> None:
    image = from_image_array(msg.Image, pixels, "mono16")
    np.testing.assert_array_equal(image_array(image), pixels.reshape(4, 3))
    assert bytes(image.data) == pixels.astype("<u2").tobytes()


@pytest.mark.parametrize("encoding", ["nv12", "nv21", "nv24"])
def test_planes(msg: SimpleNamespace, encoding: str) -> None:
    rows, columns, step, block = 4, 6, 8, 1 if encoding == "nv24" else 2
    chroma_step = 2 * step // block
    data = bytes(range(rows * step + rows // block * chroma_step))
    image = msg.Image(height=rows, width=columns, encoding=encoding, step=step, data=data)
    luma, chroma = image_planes(image)
    assert luma.tolist() == [[row * step + column for column in range(columns)] for row in range(rows)]
    assert chroma.shape == (rows // block, columns // block, 2)
    assert chroma[1, 2].tolist() == [rows * step + chroma_step + 4, rows * step + chroma_step + 5]
    again = from_image_planes(msg.Image, luma, chroma, encoding)
    assert (again.height, again.width, again.step) == (rows, columns, columns)
    assert bytes(again.data) == luma.tobytes() + chroma.tobytes()
    for one, other in zip(image_planes(again), (luma, chroma), strict=True):
        np.testing.assert_array_equal(one, other)
    chroma[0, 0] = 255
    assert image.data[rows * step] == 255


def test_an_image_without_pixels_has_none(msg: SimpleNamespace) -> None:
    assert image_array(msg.Image(height=2**32 - 1, encoding="rgb8")).shape == (2**32 - 1, 0, 3)
    assert image_array(from_image_array(msg.Image, np.zeros((0, 5), np.uint8), "mono8")).shape == (0, 5)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"step": 14}, "Image.step: expected at least 15 for 5 pixels in rgb8, got 14"),
        ({"height": 4}, "Image.data: expected at least 60 bytes for the height and step, got 45"),
        ({"height": -1}, "Image.height: expected an integer in [0, 4294967295], got -1"),
        ({"width": "5"}, "Image.width: expected an integer in [0, 4294967295], got '5'"),
        (
            {"_data": array("B", bytes(44))},
            "Image.data: expected at least 45 bytes for the height and step, got 44",
        ),
        ({"_data": [1, 2]}, "Image.data: expected a contiguous array of uint8, got list"),
        (
            {"_data": array("H", [1])},
            "Image.data: expected a contiguous array of uint8, got array.array of uint16 and shape (1,)",
        ),
        ({"encoding": "nv12"}, "Image.encoding: nv12 has two planes: use image_planes"),
    ],
)
def test_an_image_that_contradicts_itself(msg: SimpleNamespace, change: dict[str, Any], error: str) -> None:
    image = from_image_array(msg.Image, np.zeros((3, 5, 3), np.uint8), "rgb8")
    for name, value in change.items():
        setattr(image, name, value)
    with pytest.raises(ConversionError) as raised:
        image_array(image)
    assert str(raised.value) == error


@pytest.mark.parametrize(
    "encoding", ["", "RGB8", "rgb", "8UC0", "8UC513", "8FC1", "8UC٣", "16FC1 ", "x" * 10**6, None]
)
def test_an_encoding_that_is_not_known_says_which_are(msg: SimpleNamespace, encoding: Any) -> None:
    with pytest.raises(
        ConversionError, match=r"^Image\.encoding: .* is not known.*; known are mono8, .*nv24, and 8UCn"
    ) as raised:
        from_image_array(msg.Image, np.zeros((3, 5, 3), np.uint8), encoding)
    assert len(str(raised.value)) < 600
    assert ("did you mean 'rgb8'?" in str(raised.value)) is (encoding in ("RGB8", "rgb"))


@pytest.mark.parametrize(
    ("pixels", "encoding", "error"),
    [
        (
            np.zeros((3, 5, 3)),
            "rgb8",
            "rgb8 needs uint8 of shape (height, width, 3), got float64 and shape (3, 5, 3)",
        ),
        (
            np.zeros((3, 5), "u1"),
            "rgb8",
            "rgb8 needs uint8 of shape (height, width, 3), got uint8 and shape (3, 5)",
        ),
        (
            np.zeros((3, 5, 3), "u1"),
            "mono8",
            "mono8 needs uint8 of shape (height, width, 1), got uint8 and shape (3, 5, 3)",
        ),
        (np.zeros(5, "u1"), "mono8", "mono8 needs uint8 of shape (height, width), got uint8 and shape (5,)"),
        (
            np.zeros((3, 5), "f4"),
            "64FC1",
            "64FC1 needs float64 of shape (height, width), got float32 and shape (3, 5)",
        ),
    ],
)
def test_an_array_that_does_not_fit(msg: SimpleNamespace, pixels: Any, encoding: str, error: str) -> None:
    with pytest.raises(ConversionError) as raised:
        from_image_array(msg.Image, pixels, encoding)
    assert str(raised.value) == f"Image.data: {error}"


def test_planes_that_do_not_fit(msg: SimpleNamespace) -> None:
    luma, chroma = np.zeros((4, 6), np.uint8), np.zeros((2, 3, 2), np.uint8)
    for arguments, error in (
        (
            (luma, chroma, "nv24"),
            r"Image\.data: nv24 needs uint8 of shape \(4, 6, 2\), got uint8 and shape \(2, 3, 2\)",
        ),
        ((luma[:, :5], chroma, "nv12"), r"Image\.width: nv12 needs an even number, got 5"),
        ((luma, chroma, "rgb8"), r"Image\.encoding: rgb8 has one plane: use from_image_array"),
    ):
        with pytest.raises(ConversionError, match=f"^{error}$"):
            from_image_planes(msg.Image, *arguments)
    with pytest.raises(
        ConversionError, match=r"^Image\.encoding: nv12 has two planes: use from_image_planes$"
    ):
        from_image_array(msg.Image, luma, "nv12")
    with pytest.raises(TypeError, match="got geometry_msgs/msg/Pose, which has no field 'height'"):
        image_array(msg.Pose())


def test_an_image_beyond_what_its_fields_can_say_is_not_allocated(msg: SimpleNamespace) -> None:
    pixels = np.broadcast_to(np.uint8(0), (2**16, 2**16 + 1))
    with pytest.raises(ConversionError, match=r"^Image\.data: expected at most 4294967295, got 4295032832$"):
        from_image_array(msg.Image, pixels, "mono8")
