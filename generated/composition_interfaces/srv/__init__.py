"""Services of composition_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from composition_interfaces.srv._list_nodes import ListNodes as ListNodes
    from composition_interfaces.srv._list_nodes import ListNodes_Event as ListNodes_Event
    from composition_interfaces.srv._list_nodes import ListNodes_Request as ListNodes_Request
    from composition_interfaces.srv._list_nodes import ListNodes_Response as ListNodes_Response
    from composition_interfaces.srv._load_node import LoadNode as LoadNode
    from composition_interfaces.srv._load_node import LoadNode_Event as LoadNode_Event
    from composition_interfaces.srv._load_node import LoadNode_Request as LoadNode_Request
    from composition_interfaces.srv._load_node import LoadNode_Response as LoadNode_Response
    from composition_interfaces.srv._unload_node import UnloadNode as UnloadNode
    from composition_interfaces.srv._unload_node import UnloadNode_Event as UnloadNode_Event
    from composition_interfaces.srv._unload_node import UnloadNode_Request as UnloadNode_Request
    from composition_interfaces.srv._unload_node import UnloadNode_Response as UnloadNode_Response

__all__ = [
    "ListNodes",
    "ListNodes_Event",
    "ListNodes_Request",
    "ListNodes_Response",
    "LoadNode",
    "LoadNode_Event",
    "LoadNode_Request",
    "LoadNode_Response",
    "UnloadNode",
    "UnloadNode_Event",
    "UnloadNode_Request",
    "UnloadNode_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "ListNodes": "_list_nodes",
        "ListNodes_Event": "_list_nodes",
        "ListNodes_Request": "_list_nodes",
        "ListNodes_Response": "_list_nodes",
        "LoadNode": "_load_node",
        "LoadNode_Event": "_load_node",
        "LoadNode_Request": "_load_node",
        "LoadNode_Response": "_load_node",
        "UnloadNode": "_unload_node",
        "UnloadNode_Event": "_unload_node",
        "UnloadNode_Request": "_unload_node",
        "UnloadNode_Response": "_unload_node",
    },
)
