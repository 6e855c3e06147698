"""sensor_msgs/msg/Image and its encodings; numpy arrays of (rows, columns[, channels]), top row first.

The names of encodings are those of sensor_msgs/image_encodings.hpp (Jazzy), and `nv12`, which newer ROS has.
"""

from __future__ import annotations

import difflib
import re
from array import array
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ifgen_runtime.codec.encoding import shown
from ifgen_runtime.errors import ConversionError
from ifgen_runtime.numpy.fields import (
    checked_size,
    copied,
    described,
    name_of,
    new_message,
    octets_in,
    require,
    size_in,
)
from ifgen_runtime.numpy.messages import ImageMessage

MAXIMUM_CHANNELS = 512  # CV_CN_MAX of OpenCV, from which names such as 8UC1 come


@dataclass(frozen=True, slots=True)
class Encoding:
    """The contents of an image's rows: `channels` numbers of `dtype` for each pixel.

    `subsampling` is 0 if there is one plane. Otherwise a second plane follows, which holds a pair of chroma
    values for each block of `subsampling` by `subsampling` pixels.
    """

    name: str
    dtype: str
    channels: int = 1
    subsampling: int = 0


_BAYER = tuple(f"bayer_{pattern}" for pattern in ("rggb", "bggr", "gbrg", "grbg"))
_CHANNELS = {"mono": 1, **dict.fromkeys(_BAYER, 1), "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}
_PACKED = ("uyvy", "yuyv", "yuv422", "yuv422_yuy2")
_SUBSAMPLING = {"nv12": 2, "nv21": 2, "nv24": 1}
_NAMED = {
    encoding.name: encoding
    for encoding in (
        *(Encoding(f"{name}8", "u1", channels) for name, channels in _CHANNELS.items()),
        *(Encoding(f"{name}16", "u2", channels) for name, channels in _CHANNELS.items()),
        *(Encoding(name, "u1", 2) for name in _PACKED),
        *(Encoding(name, "u1", subsampling=subsampling) for name, subsampling in _SUBSAMPLING.items()),
    )
}
_OPENCV = re.compile(r"(?:(8|16|32|64)([US])|(16|32|64)(F))C([0-9]{0,3})")
_KINDS = {"U": "u", "S": "i", "F": "f"}
_KNOWN = (
    f"{', '.join(_NAMED)}, and 8UCn to 64UCn, 8SCn to 64SCn, 16FCn to 64FCn "
    f"with n from 1 to {MAXIMUM_CHANNELS} channels"
)


def encoding_of(text: object, path: str) -> Encoding:
    """The encoding of this name; ConversionError, which lists those that are known, if there is none."""
    short = text if isinstance(text, str) and len(text) <= 20 else ""
    encoding = _known(short)
    if encoding is None:
        close = difflib.get_close_matches(short.lower(), _NAMED, n=1)
        meant = f" (did you mean '{close[0]}'?)" if close else ""
        raise ConversionError(path, f"{shown(text)} is not known{meant}; known are {_KNOWN}")
    return encoding


@lru_cache(maxsize=64)
def _known(text: str) -> Encoding | None:
    if text in _NAMED:
        return _NAMED[text]
    match = _OPENCV.fullmatch(text)
    if match is None:
        return None
    bits, kind = match[1] or match[3], match[2] or match[4]
    channels = int(match[5] or "1")
    if not 1 <= channels <= MAXIMUM_CHANNELS:
        return None
    return Encoding(text, f"{_KINDS[kind]}{int(bits) // 8}", channels)


ImageT = TypeVar("ImageT", bound=ImageMessage)

_IMAGE = "sensor_msgs/msg/Image"
_FIELDS = ("height", "width", "encoding", "is_bigendian", "step", "data")


def image_array(image: ImageMessage) -> NDArray[Any]:
    """View the pixels of a sensor_msgs/msg/Image without a copy.

    The shape is (height, width) if the encoding has one channel, as mono8, 32FC1 and bayer_rggb8 have, and
    (height, width, channels) if it has more. Channels have the order of the encoding: bgr8 is blue, green,
    red. In uyvy and yuv422, channel 1 is the luma, and channel 0 is U in even columns and V in odd ones. In
    yuyv and yuv422_yuy2, channel 0 is the luma, and channel 1 the chroma.

    The dtype has the byte order that `is_bigendian` states. The view skips padding at the ends of rows
    (`step`), so its rows need not be contiguous. Writing to the view writes to the image.

    Raise ConversionError if the encoding is not known, if it has two planes (nv12, nv21 and nv24; see
    `image_planes`), or if `step` or `data` is too small.
    """
    require(image, _IMAGE, *_FIELDS)
    encoding = _encoding(image, image.encoding, planar=False, otherwise="image_planes")
    shape = (size_in(image, "height"), size_in(image, "width"), encoding.channels)
    pixels = _plane(image, shape, _dtype(encoding, big_endian=bool(image.is_bigendian)))
    return pixels if encoding.channels > 1 else pixels[:, :, 0]


def image_planes(image: ImageMessage) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """View the two planes of an image in nv12, nv21 or nv24 without a copy.

    The first is the luma, of shape (height, width). The second is the chroma, of shape (height / 2, width /
    2, 2), or (height, width, 2) in nv24. Its channels are U and V in nv12 and nv24, and V and U in nv21.
    Its rows follow those of the luma in `data`, with the same `step` (twice that in nv24), as in
    Video4Linux.

    Writing to the views writes to the image. Raise ConversionError as `image_array` does, and if the
    encoding has one plane.
    """
    require(image, _IMAGE, *_FIELDS)
    encoding = _encoding(image, image.encoding, planar=True, otherwise="image_array")
    height, width = size_in(image, "height"), size_in(image, "width")
    blocks = _blocks(image, encoding, height, width)
    luma = _plane(image, (height, width, 1), np.dtype(np.uint8))
    steps = 2 // encoding.subsampling
    return luma[:, :, 0], _plane(image, (*blocks, 2), np.dtype(np.uint8), after=height, steps=steps)


def from_image_array(cls: type[ImageT], pixels: ArrayLike, encoding: str, *, header: object = None) -> ImageT:
    """Make an image of this class (sensor_msgs.msg.Image) from pixels, which are copied once.

    `pixels` has the shape that `image_array` returns for the encoding; (height, width, 1) is accepted for one
    channel. Its item type must be that of the encoding: uint8 for rgb8, float32 for 32FC1. Byte order and
    strides do not matter: the image is little endian, without padding. Without `header` the image has a
    default one.

    Raise ConversionError if the encoding is not known, if it has two planes (see `from_image_planes`), or if
    the array does not fit it.
    """
    found = _encoding(cls, encoding, planar=False, otherwise="from_image_planes")
    values = np.asarray(pixels)
    flat = found.channels == 1 and values.ndim != 3
    _check_array(cls, found, values, (None, None) if flat else (None, None, found.channels))
    return _image(cls, found, values.shape, copied(cls, "data", values, _dtype(found)), header)


def from_image_planes(
    cls: type[ImageT],
    luma: ArrayLike,
    chroma: ArrayLike,
    encoding: str,
    *,
    header: object = None,
) -> ImageT:
    """Make an image of this class in nv12, nv21 or nv24 from planes as `image_planes` returns them.

    The planes are copied. Raise ConversionError if they do not fit each other, or if the encoding has one
    plane.
    """
    found = _encoding(cls, encoding, planar=True, otherwise="from_image_array")
    planes = np.asarray(luma), np.asarray(chroma)
    _check_array(cls, found, planes[0], (None, None))
    _check_array(cls, found, planes[1], (*_blocks(cls, found, *planes[0].shape), 2))
    rows, pairs = (copied(cls, "data", plane, _dtype(found)) for plane in planes)
    return _image(cls, found, planes[0].shape, rows + pairs, header)


def _dtype(encoding: Encoding, *, big_endian: bool = False) -> np.dtype[Any]:
    return np.dtype(encoding.dtype).newbyteorder(">" if big_endian else "<")


def _encoding(image: object, name: str, *, planar: bool, otherwise: str) -> Encoding:
    """The encoding of this name; ConversionError if the function called `otherwise` is the one for it."""
    path = f"{name_of(image)}.encoding"
    encoding = encoding_of(name, path)
    if bool(encoding.subsampling) is not planar:
        planes = "one plane" if planar else "two planes"
        raise ConversionError(path, f"{encoding.name} has {planes}: use {otherwise}")
    return encoding


def _blocks(image: object, encoding: Encoding, height: int, width: int) -> tuple[int, int]:
    """The rows and columns of the chroma plane."""
    for name, size in (("height", height), ("width", width)):
        if size % encoding.subsampling:
            raise ConversionError(
                f"{name_of(image)}.{name}", f"{encoding.name} needs an even number, got {size}"
            )
    return height // encoding.subsampling, width // encoding.subsampling


def _plane(
    image: ImageMessage, shape: tuple[int, int, int], dtype: np.dtype[Any], *, after: int = 0, steps: int = 1
) -> NDArray[Any]:
    """View pixels of this shape in `data`, after the given number of steps; a row takes `steps` of them."""
    rows, columns, channels = shape
    if rows * columns == 0:
        return np.empty(shape, dtype)
    step, data = size_in(image, "step"), octets_in(image, "data")
    stride = steps * step
    row_size = columns * channels * dtype.itemsize
    if stride < row_size:
        raise ConversionError(
            f"{name_of(image)}.step",
            f"expected at least {row_size // steps} for {image.width} pixels in {image.encoding}, got {step}",
        )
    start = after * step
    end = start + (rows - 1) * stride + row_size
    if len(data) < end:
        raise ConversionError(
            f"{name_of(image)}.data",
            f"expected at least {end} bytes for the height and step, got {len(data)}",
        )
    return np.ndarray(shape, dtype, data, start, (stride, channels * dtype.itemsize, dtype.itemsize))


def _check_array(
    cls: type[Any], encoding: Encoding, values: NDArray[Any], shape: tuple[int | None, ...]
) -> None:
    dtype = np.dtype(encoding.dtype)
    fits = values.ndim == len(shape) and all(
        n in (None, size) for n, size in zip(shape, values.shape, strict=True)
    )
    if not fits or values.dtype.newbyteorder("=") != dtype:
        names = [("height", "width")[i] if n is None else str(n) for i, n in enumerate(shape)]
        raise ConversionError(
            f"{cls.__name__}.data",
            f"{encoding.name} needs {dtype} of shape ({', '.join(names)}), got {described(values)}",
        )


def _image(
    cls: type[ImageT], encoding: Encoding, shape: tuple[int, ...], data: array[int], header: object
) -> ImageT:
    height, width = shape[:2]
    step = width * encoding.channels * np.dtype(encoding.dtype).itemsize
    fields = {
        "height": checked_size(cls, "height", height),
        "width": checked_size(cls, "width", width),
        "encoding": encoding.name,
        "is_bigendian": 0,
        "step": checked_size(cls, "step", step),
        "data": data,
    }
    message: ImageT = new_message(cls, _IMAGE, header, fields)
    return message
