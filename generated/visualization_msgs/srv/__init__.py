"""Services of visualization_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from visualization_msgs.srv._get_interactive_markers import GetInteractiveMarkers as GetInteractiveMarkers
    from visualization_msgs.srv._get_interactive_markers import (
        GetInteractiveMarkers_Event as GetInteractiveMarkers_Event,
    )
    from visualization_msgs.srv._get_interactive_markers import (
        GetInteractiveMarkers_Request as GetInteractiveMarkers_Request,
    )
    from visualization_msgs.srv._get_interactive_markers import (
        GetInteractiveMarkers_Response as GetInteractiveMarkers_Response,
    )

__all__ = [
    "GetInteractiveMarkers",
    "GetInteractiveMarkers_Event",
    "GetInteractiveMarkers_Request",
    "GetInteractiveMarkers_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "GetInteractiveMarkers": "_get_interactive_markers",
        "GetInteractiveMarkers_Event": "_get_interactive_markers",
        "GetInteractiveMarkers_Request": "_get_interactive_markers",
        "GetInteractiveMarkers_Response": "_get_interactive_markers",
    },
)
