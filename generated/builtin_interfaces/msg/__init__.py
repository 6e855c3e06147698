"""Messages of builtin_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from builtin_interfaces.msg._duration import Duration as Duration
    from builtin_interfaces.msg._time import Time as Time

__all__ = [
    "Duration",
    "Time",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Duration": "_duration",
        "Time": "_time",
    },
)
