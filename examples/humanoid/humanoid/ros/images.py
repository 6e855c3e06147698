"""Pictures as messages, and back."""

from __future__ import annotations

from array import array

from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from ..sensing.camera import Lens, Picture, decoded, encoded


def image(header: Header, picture: Picture, encoding: str = "rgb8") -> Image:
    """A picture (height, width, 3) for image_raw, in an encoding."""
    pixels = encoded(picture, encoding)
    height, width, planes = pixels.shape
    return Image(
        header=header,
        height=height,
        width=width,
        encoding=encoding,
        step=width * planes,
        data=array("B", pixels.tobytes()),
    )


def read_image(message: Image) -> Picture:
    """The picture (height, width, 3) in a message. Raises ValueError if it cannot be read."""
    return decoded(
        memoryview(message.data).tobytes(), message.encoding, message.width, message.height, message.step
    )


def camera_info(header: Header, lens: Lens) -> CameraInfo:
    """The calibration of a camera without distortion."""
    focal, x, y = lens.focal, lens.x, lens.y
    return CameraInfo(
        header=header,
        height=lens.height,
        width=lens.width,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def read_lens(message: CameraInfo) -> Lens | None:
    """The calibration in a message; None if the camera is not calibrated. Distortion is not looked at."""
    focal, x, y = message.k[0], message.k[2], message.k[5]
    return Lens(message.width, message.height, focal, x, y) if focal > 0 else None
