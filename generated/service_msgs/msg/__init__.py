"""Messages of service_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from service_msgs.msg._service_event_info import ServiceEventInfo as ServiceEventInfo

__all__ = [
    "ServiceEventInfo",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "ServiceEventInfo": "_service_event_info",
    },
)
