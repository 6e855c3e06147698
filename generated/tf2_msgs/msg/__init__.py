"""Messages of tf2_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from tf2_msgs.msg._tf2_error import TF2Error as TF2Error
    from tf2_msgs.msg._tf_message import TFMessage as TFMessage

__all__ = [
    "TF2Error",
    "TFMessage",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "TF2Error": "_tf2_error",
        "TFMessage": "_tf_message",
    },
)
