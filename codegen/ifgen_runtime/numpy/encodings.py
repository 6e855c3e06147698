"""The encodings of sensor_msgs/msg/Image: the numbers that each pixel consists of.

The names are those of sensor_msgs/image_encodings.hpp (Jazzy), and `nv12`, which newer ROS has.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import lru_cache

from ifgen_runtime.codec.encoding import shown
from ifgen_runtime.errors import ConversionError

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
