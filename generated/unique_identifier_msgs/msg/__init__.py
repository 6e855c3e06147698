"""Messages of unique_identifier_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from unique_identifier_msgs.msg._uuid import UUID as UUID

__all__ = [
    "UUID",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "UUID": "_uuid",
    },
)
