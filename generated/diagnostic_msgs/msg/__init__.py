"""Messages of diagnostic_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from diagnostic_msgs.msg._diagnostic_array import DiagnosticArray as DiagnosticArray
    from diagnostic_msgs.msg._diagnostic_status import DiagnosticStatus as DiagnosticStatus
    from diagnostic_msgs.msg._key_value import KeyValue as KeyValue

__all__ = [
    "DiagnosticArray",
    "DiagnosticStatus",
    "KeyValue",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "DiagnosticArray": "_diagnostic_array",
        "DiagnosticStatus": "_diagnostic_status",
        "KeyValue": "_key_value",
    },
)
