"""What a camera's driver does with the pictures of its sensor: size, encoding and calibration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]  # (height, width, 3), red, green, blue
_GREY = np.array([0.299, 0.587, 0.114])


@dataclass(frozen=True, slots=True)
class Lens:
    """A lens without distortion: the focal length and the optical centre in pixels."""

    width: int
    height: int
    focal: float
    x: float
    y: float


def lens_of(width: int, height: int, fovy: float) -> Lens:
    """The calibration of pictures of a size, from the vertical field of view [degrees]."""
    focal = height / 2 / math.tan(math.radians(fovy) / 2)
    return Lens(width, height, focal, width / 2, height / 2)


def resized(picture: Picture, width: int, height: int) -> Picture:
    """The middle of a picture in another size: the whole height, and as much of the width as is there.

    Each new pixel is the nearest old one. Raises ValueError if the picture is not wide enough.
    """
    rows, columns = picture.shape[:2]
    if (columns, rows) == (width, height):
        return picture
    scale = rows / height
    if round(width * scale) > columns:
        raise ValueError(f"a picture of {columns} x {rows} is not wide enough for {width} x {height}")
    y = ((np.arange(height) + 0.5) * scale).astype(int)
    x = (columns / 2 + (np.arange(width) + 0.5 - width / 2) * scale).astype(int)
    chosen: Picture = picture[y[:, None], x[None, :]]
    return chosen


def encoded(picture: Picture, encoding: str) -> NDArray[np.uint8]:
    """The bytes of a picture as `rgb8`, `bgr8` or `mono8`: (height, width, 3 or 1)."""
    match encoding:
        case "rgb8":
            return picture
        case "bgr8":
            return np.ascontiguousarray(picture[:, :, ::-1])
        case "mono8":
            grey: NDArray[np.uint8] = np.rint(picture @ _GREY).astype(np.uint8)
            return grey[:, :, None]
        case _:
            raise ValueError(f"there is no encoding '{encoding}'")


def decoded(data: bytes, encoding: str, width: int, height: int, step: int) -> Picture:
    """The picture in the bytes of an image. Raises ValueError if they cannot be read."""
    planes = {"rgb8": 3, "bgr8": 3, "mono8": 1}.get(encoding)
    if planes is None:
        raise ValueError(f"an image with encoding '{encoding}' cannot be read: send rgb8, bgr8 or mono8")
    if step < width * planes or len(data) != height * step or not width or not height:
        raise ValueError(f"{len(data)} bytes in rows of {step} are no image of {width} x {height}")
    rows = np.frombuffer(data, dtype=np.uint8).reshape(height, step)
    picture = rows[:, : width * planes].reshape(height, width, planes)
    if encoding == "bgr8":
        picture = picture[:, :, ::-1]
    return np.repeat(picture, 3, axis=2) if planes == 1 else picture
