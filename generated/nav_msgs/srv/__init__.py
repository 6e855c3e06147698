"""Services of nav_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from nav_msgs.srv._get_map import GetMap as GetMap
    from nav_msgs.srv._get_map import GetMap_Event as GetMap_Event
    from nav_msgs.srv._get_map import GetMap_Request as GetMap_Request
    from nav_msgs.srv._get_map import GetMap_Response as GetMap_Response
    from nav_msgs.srv._get_plan import GetPlan as GetPlan
    from nav_msgs.srv._get_plan import GetPlan_Event as GetPlan_Event
    from nav_msgs.srv._get_plan import GetPlan_Request as GetPlan_Request
    from nav_msgs.srv._get_plan import GetPlan_Response as GetPlan_Response
    from nav_msgs.srv._load_map import LoadMap as LoadMap
    from nav_msgs.srv._load_map import LoadMap_Event as LoadMap_Event
    from nav_msgs.srv._load_map import LoadMap_Request as LoadMap_Request
    from nav_msgs.srv._load_map import LoadMap_Response as LoadMap_Response
    from nav_msgs.srv._set_map import SetMap as SetMap
    from nav_msgs.srv._set_map import SetMap_Event as SetMap_Event
    from nav_msgs.srv._set_map import SetMap_Request as SetMap_Request
    from nav_msgs.srv._set_map import SetMap_Response as SetMap_Response

__all__ = [
    "GetMap",
    "GetMap_Event",
    "GetMap_Request",
    "GetMap_Response",
    "GetPlan",
    "GetPlan_Event",
    "GetPlan_Request",
    "GetPlan_Response",
    "LoadMap",
    "LoadMap_Event",
    "LoadMap_Request",
    "LoadMap_Response",
    "SetMap",
    "SetMap_Event",
    "SetMap_Request",
    "SetMap_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "GetMap": "_get_map",
        "GetMap_Event": "_get_map",
        "GetMap_Request": "_get_map",
        "GetMap_Response": "_get_map",
        "GetPlan": "_get_plan",
        "GetPlan_Event": "_get_plan",
        "GetPlan_Request": "_get_plan",
        "GetPlan_Response": "_get_plan",
        "LoadMap": "_load_map",
        "LoadMap_Event": "_load_map",
        "LoadMap_Request": "_load_map",
        "LoadMap_Response": "_load_map",
        "SetMap": "_set_map",
        "SetMap_Event": "_set_map",
        "SetMap_Request": "_set_map",
        "SetMap_Response": "_set_map",
    },
)
