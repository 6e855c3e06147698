"""Services of example_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from example_interfaces.srv._add_two_ints import AddTwoInts as AddTwoInts
    from example_interfaces.srv._add_two_ints import AddTwoInts_Event as AddTwoInts_Event
    from example_interfaces.srv._add_two_ints import AddTwoInts_Request as AddTwoInts_Request
    from example_interfaces.srv._add_two_ints import AddTwoInts_Response as AddTwoInts_Response
    from example_interfaces.srv._set_bool import SetBool as SetBool
    from example_interfaces.srv._set_bool import SetBool_Event as SetBool_Event
    from example_interfaces.srv._set_bool import SetBool_Request as SetBool_Request
    from example_interfaces.srv._set_bool import SetBool_Response as SetBool_Response
    from example_interfaces.srv._trigger import Trigger as Trigger
    from example_interfaces.srv._trigger import Trigger_Event as Trigger_Event
    from example_interfaces.srv._trigger import Trigger_Request as Trigger_Request
    from example_interfaces.srv._trigger import Trigger_Response as Trigger_Response

__all__ = [
    "AddTwoInts",
    "AddTwoInts_Event",
    "AddTwoInts_Request",
    "AddTwoInts_Response",
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
        "AddTwoInts": "_add_two_ints",
        "AddTwoInts_Event": "_add_two_ints",
        "AddTwoInts_Request": "_add_two_ints",
        "AddTwoInts_Response": "_add_two_ints",
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
