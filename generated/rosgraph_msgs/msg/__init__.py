"""Messages of rosgraph_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from rosgraph_msgs.msg._clock import Clock as Clock

__all__ = [
    "Clock",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Clock": "_clock",
    },
)
