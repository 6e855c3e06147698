"""Services of test_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from test_msgs.srv._arrays import Arrays as Arrays
    from test_msgs.srv._arrays import Arrays_Event as Arrays_Event
    from test_msgs.srv._arrays import Arrays_Request as Arrays_Request
    from test_msgs.srv._arrays import Arrays_Response as Arrays_Response
    from test_msgs.srv._basic_types import BasicTypes as BasicTypes
    from test_msgs.srv._basic_types import BasicTypes_Event as BasicTypes_Event
    from test_msgs.srv._basic_types import BasicTypes_Request as BasicTypes_Request
    from test_msgs.srv._basic_types import BasicTypes_Response as BasicTypes_Response
    from test_msgs.srv._empty import Empty as Empty
    from test_msgs.srv._empty import Empty_Event as Empty_Event
    from test_msgs.srv._empty import Empty_Request as Empty_Request
    from test_msgs.srv._empty import Empty_Response as Empty_Response

__all__ = [
    "Arrays",
    "Arrays_Event",
    "Arrays_Request",
    "Arrays_Response",
    "BasicTypes",
    "BasicTypes_Event",
    "BasicTypes_Request",
    "BasicTypes_Response",
    "Empty",
    "Empty_Event",
    "Empty_Request",
    "Empty_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Arrays": "_arrays",
        "Arrays_Event": "_arrays",
        "Arrays_Request": "_arrays",
        "Arrays_Response": "_arrays",
        "BasicTypes": "_basic_types",
        "BasicTypes_Event": "_basic_types",
        "BasicTypes_Request": "_basic_types",
        "BasicTypes_Response": "_basic_types",
        "Empty": "_empty",
        "Empty_Event": "_empty",
        "Empty_Request": "_empty",
        "Empty_Response": "_empty",
    },
)
