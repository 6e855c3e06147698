"""Messages of stereo_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from stereo_msgs.msg._disparity_image import DisparityImage as DisparityImage

__all__ = [
    "DisparityImage",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "DisparityImage": "_disparity_image",
    },
)
