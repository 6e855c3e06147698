"""Services of tf2_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from tf2_msgs.srv._frame_graph import FrameGraph as FrameGraph
    from tf2_msgs.srv._frame_graph import FrameGraph_Event as FrameGraph_Event
    from tf2_msgs.srv._frame_graph import FrameGraph_Request as FrameGraph_Request
    from tf2_msgs.srv._frame_graph import FrameGraph_Response as FrameGraph_Response

__all__ = [
    "FrameGraph",
    "FrameGraph_Event",
    "FrameGraph_Request",
    "FrameGraph_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "FrameGraph": "_frame_graph",
        "FrameGraph_Event": "_frame_graph",
        "FrameGraph_Request": "_frame_graph",
        "FrameGraph_Response": "_frame_graph",
    },
)
