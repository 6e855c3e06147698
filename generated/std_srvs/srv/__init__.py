"""Services of std_srvs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from std_srvs.srv._empty import Empty as Empty
    from std_srvs.srv._empty import Empty_Event as Empty_Event
    from std_srvs.srv._empty import Empty_Request as Empty_Request
    from std_srvs.srv._empty import Empty_Response as Empty_Response
    from std_srvs.srv._set_bool import SetBool as SetBool
    from std_srvs.srv._set_bool import SetBool_Event as SetBool_Event
    from std_srvs.srv._set_bool import SetBool_Request as SetBool_Request
    from std_srvs.srv._set_bool import SetBool_Response as SetBool_Response
    from std_srvs.srv._trigger import Trigger as Trigger
    from std_srvs.srv._trigger import Trigger_Event as Trigger_Event
    from std_srvs.srv._trigger import Trigger_Request as Trigger_Request
    from std_srvs.srv._trigger import Trigger_Response as Trigger_Response

__all__ = [
    "Empty",
    "Empty_Event",
    "Empty_Request",
    "Empty_Response",
    "SetBool",
    "SetBool_Event",
    "SetBool_Request",
    "SetBool_Response",
    "Trigger",
    "Trigger_Event",
    "Trigger_Request",
    "Trigger_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Empty": "_empty",
        "Empty_Event": "_empty",
        "Empty_Request": "_empty",
        "Empty_Response": "_empty",
        "SetBool": "_set_bool",
        "SetBool_Event": "_set_bool",
        "SetBool_Request": "_set_bool",
        "SetBool_Response": "_set_bool",
        "Trigger": "_trigger",
        "Trigger_Event": "_trigger",
        "Trigger_Request": "_trigger",
        "Trigger_Response": "_trigger",
    },
)
