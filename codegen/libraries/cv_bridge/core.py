# Arrays and messages are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""The bridge. OpenCV is needed for compressed images and for Bayer and YUV encodings only."""

from __future__ import annotations

import re
import sys
from array import array
from importlib import import_module
from typing import Any, Final

import numpy as np
from sensor_msgs.msg import CompressedImage, Image

__all__ = ["CvBridge", "CvBridgeError"]

_DTYPES: Final = {
    **{"8U": "uint8", "8S": "int8", "16U": "uint16", "16S": "int16"},
    **{"32S": "int32", "32F": "float32", "64F": "float64"},
}
_DEPTHS: Final = {name: depth for depth, name in _DTYPES.items()}
_TYPE: Final = re.compile(r"(8U|8S|16U|16S|32S|32F|64F)(?:C(\d+))?")
_COLOUR: Final = re.compile(r"(mono|bgra|rgba|bgr|rgb)(8|16)")
_SAMPLED: Final = re.compile(r"bayer_(rggb|bggr|gbrg|grbg)(8|16)|yuv422(?:_yuy2)?|uyvy|yuyv")
_CHANNELS: Final = {"mono": 1, "bgr": 3, "rgb": 3, "bgra": 4, "rgba": 4}
_BAYER: Final = {"rggb": "BG", "bggr": "RG", "gbrg": "GR", "grbg": "GB"}
"""The names in OpenCV, which begin with the second row."""


class CvBridgeError(TypeError):
    """A conversion that makes no sense, or that needs OpenCV where there is none."""


class CvBridge:
    """Converts images of ROS to numpy arrays of (height, width) or (height, width, channels), and back."""

    def encoding_to_cvtype2(self, encoding: str) -> str:
        """Return the type of an encoding, such as `8UC3` of `bgr8`. Raises CvBridgeError."""
        dtype, channels = self.encoding_to_dtype_with_channels(encoding)
        return self.dtype_with_channels_to_cvtype2(dtype, channels)

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return the numpy type and the number of channels of an encoding. Raises CvBridgeError."""
        if found := _TYPE.fullmatch(encoding):
            return _DTYPES[found[1]], int(found[2] or 1)
        if found := _COLOUR.fullmatch(encoding):
            return f"uint{found[2]}", _CHANNELS[found[1]]
        if found := _SAMPLED.fullmatch(encoding):
            return f"uint{found[2] or 8}", 1 if encoding.startswith("bayer") else 2
        raise CvBridgeError(f"Unrecognized image encoding [{encoding}]")

    def dtype_with_channels_to_cvtype2(self, dtype: Any, n_channels: int) -> str:
        """Return the type of an array, such as `8UC3`. Raises CvBridgeError."""
        name = np.dtype(dtype).name
        if name not in _DEPTHS:
            known = ", ".join(_DEPTHS)
            raise CvBridgeError(f"an image cannot have elements of type {name}: there are {known}")
        return f"{_DEPTHS[name]}C{n_channels}"

    def imgmsg_to_cv2(self, img_msg: Image, desired_encoding: str = "passthrough") -> Any:
        """Return an image as an array: as it is, which shares its data, or in an encoding.

        Raises CvBridgeError for a conversion that makes no sense, and for too little data.
        """
        dtype, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        order = np.dtype(dtype).newbyteorder(">" if img_msg.is_bigendian else "<")
        height, width = img_msg.height, img_msg.width
        row = width * channels * order.itemsize
        if img_msg.step < row or len(img_msg.data) < img_msg.step * height:
            raise CvBridgeError(
                f"an image of {width} x {height} pixels in {img_msg.encoding} needs rows of {row} bytes, "
                f"got a step of {img_msg.step} and {len(img_msg.data)} bytes"
            )
        octets = np.frombuffer(img_msg.data, np.uint8)[: img_msg.step * height]
        rows = octets.reshape(height, img_msg.step)[:, :row]
        pixels = (rows if rows.flags.c_contiguous else rows.copy()).view(order)
        if not order.isnative:
            pixels = pixels.astype(order.newbyteorder("="))
        image = pixels if channels == 1 else pixels.reshape(height, width, channels)
        if desired_encoding == "passthrough":
            return image
        return self.cvt_color(image, img_msg.encoding, desired_encoding)

    def cv2_to_imgmsg(self, cvim: Any, encoding: str = "passthrough", header: Any = None) -> Image:
        """Return an array as an image. Raises TypeError, and CvBridgeError if the encoding does not fit."""
        if not isinstance(cvim, np.ndarray):
            raise TypeError("Your input type is not a numpy array")
        channels = 1 if cvim.ndim < 3 else cvim.shape[2]
        kind = self.dtype_with_channels_to_cvtype2(cvim.dtype, channels)
        if encoding != "passthrough" and self.encoding_to_cvtype2(encoding) != kind:
            raise CvBridgeError(f"encoding specified as {encoding}, but image has incompatible type {kind}")
        message = Image(height=cvim.shape[0], width=cvim.shape[1])
        message.encoding = kind if encoding == "passthrough" else encoding
        message.is_bigendian = cvim.dtype.byteorder == ">" or (
            cvim.dtype.byteorder == "=" and sys.byteorder == "big"
        )
        message.data = array("B", cvim.tobytes())
        message.step = cvim.shape[1] * channels * cvim.itemsize
        if header is not None:
            message.header = header
        return message

    def compressed_imgmsg_to_cv2(
        self, cmprs_img_msg: CompressedImage, desired_encoding: str = "passthrough"
    ) -> Any:
        """Return a compressed image as an array, in BGR. Raises CvBridgeError."""
        cv2 = _opencv("compressed images")
        image = cv2.imdecode(np.frombuffer(cmprs_img_msg.data, np.uint8), cv2.IMREAD_UNCHANGED)
        if image is None:
            raise CvBridgeError(f"the data is no image that OpenCV can read ({cmprs_img_msg.format})")
        if desired_encoding == "passthrough":
            return image
        channels = 1 if image.ndim < 3 else image.shape[2]
        depth = 16 if image.dtype == np.uint16 else 8
        source = {1: "mono", 3: "bgr", 4: "bgra"}[channels]
        return self.cvt_color(image, f"{source}{depth}", desired_encoding)

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> CompressedImage:
        """Return an array in BGR as a compressed image: jpg, png or another format of OpenCV."""
        if not isinstance(cvim, np.ndarray):
            raise TypeError("Your input type is not a numpy array")
        done, data = _opencv("compressed images").imencode(f".{dst_format}", cvim)
        if not done:
            raise CvBridgeError(f"OpenCV cannot write this image as {dst_format}")
        return CompressedImage(
            format="jpeg" if dst_format == "jpg" else dst_format, data=array("B", data.tobytes())
        )

    def cvt_color(self, image: Any, source: str, wanted: str) -> Any:
        """Return an image in another encoding. Raises CvBridgeError."""
        if source == wanted:
            return image
        dtype, channels = self.encoding_to_dtype_with_channels(wanted)
        colour, target = _COLOUR.fullmatch(source), _COLOUR.fullmatch(wanted)
        if colour is not None and target is not None:
            return _recoloured(_scaled(image, np.dtype(dtype)), colour[1], target[1])
        if _SAMPLED.fullmatch(source) and target is not None:
            found, name = _sampled(image, source)
            return _recoloured(_scaled(found, np.dtype(dtype)), name, target[1])
        if target is not None or _SAMPLED.fullmatch(wanted):
            raise CvBridgeError(
                f"[{source}] is not a color format. but [{wanted}] is. The conversion does not make sense"
            )
        given = 1 if image.ndim < 3 else image.shape[2]
        if given != channels:
            raise CvBridgeError(f"[{source}] and [{wanted}] do not have the same number of channels")
        return _cast(image, np.dtype(dtype))


def _opencv(what: str) -> Any:
    try:
        return import_module("cv2")
    except ImportError:
        raise CvBridgeError(f"{what} need OpenCV: run `pip install opencv-python-headless`") from None


def _scaled(image: Any, wanted: np.dtype[Any]) -> Any:
    """Return the values of 8 bits as 16, or the other way round: the greatest one stays the greatest."""
    if image.dtype == wanted:
        return image
    if wanted == np.uint16:
        return image.astype(np.uint16) * np.uint16(257)
    return np.rint(image / 257).astype(np.uint8)


def _cast(image: Any, wanted: np.dtype[Any]) -> Any:
    """Return values in another type: rounded, and at most the greatest one."""
    if wanted.kind == "f":
        return image.astype(wanted)
    limits = np.iinfo(wanted)
    return np.clip(np.rint(image), limits.min, limits.max).astype(wanted)


def _recoloured(image: Any, source: str, wanted: str) -> Any:
    """Return an image with its channels in another order, with or without alpha, or grey."""
    if source == wanted:
        return image
    if source == "mono":
        bgr = np.repeat(image[:, :, np.newaxis], 3, axis=2)
    else:
        bgr = image[:, :, :3] if source.startswith("bgr") else image[:, :, 2::-1]
    if wanted == "mono":
        return _grey(bgr)
    colours = bgr if wanted.startswith("bgr") else bgr[:, :, ::-1]
    if not wanted.endswith("a"):
        return np.ascontiguousarray(colours)
    opaque = np.full((*image.shape[:2], 1), np.iinfo(image.dtype).max, image.dtype)
    return np.concatenate([colours, image[:, :, 3:] if source.endswith("a") else opaque], axis=2)


def _grey(image: Any) -> Any:
    """Return the luminance of BGR, in the whole numbers of OpenCV."""
    total = image.astype(np.uint32) @ np.array((3735, 19235, 9798), np.uint32)
    return ((total + (1 << 14)) >> 15).astype(image.dtype)


def _sampled(image: Any, source: str) -> tuple[Any, str]:
    """Return a Bayer or YUV image in BGR."""
    cv2 = _opencv(f"images in {source}")
    if source.startswith("bayer"):
        code = f"COLOR_BAYER_{_BAYER[source[6:10]]}2BGR"
    else:
        code = "COLOR_YUV2BGR_UYVY" if source in {"yuv422", "uyvy"} else "COLOR_YUV2BGR_YUY2"
    return cv2.cvtColor(image, getattr(cv2, code)), "bgr"
