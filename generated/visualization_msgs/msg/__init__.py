"""Messages of visualization_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from visualization_msgs.msg._image_marker import ImageMarker as ImageMarker
    from visualization_msgs.msg._interactive_marker import InteractiveMarker as InteractiveMarker
    from visualization_msgs.msg._interactive_marker_control import (
        InteractiveMarkerControl as InteractiveMarkerControl,
    )
    from visualization_msgs.msg._interactive_marker_feedback import (
        InteractiveMarkerFeedback as InteractiveMarkerFeedback,
    )
    from visualization_msgs.msg._interactive_marker_init import InteractiveMarkerInit as InteractiveMarkerInit
    from visualization_msgs.msg._interactive_marker_pose import InteractiveMarkerPose as InteractiveMarkerPose
    from visualization_msgs.msg._interactive_marker_update import (
        InteractiveMarkerUpdate as InteractiveMarkerUpdate,
    )
    from visualization_msgs.msg._marker import Marker as Marker
    from visualization_msgs.msg._marker_array import MarkerArray as MarkerArray
    from visualization_msgs.msg._menu_entry import MenuEntry as MenuEntry
    from visualization_msgs.msg._mesh_file import MeshFile as MeshFile
    from visualization_msgs.msg._uv_coordinate import UVCoordinate as UVCoordinate

__all__ = [
    "ImageMarker",
    "InteractiveMarker",
    "InteractiveMarkerControl",
    "InteractiveMarkerFeedback",
    "InteractiveMarkerInit",
    "InteractiveMarkerPose",
    "InteractiveMarkerUpdate",
    "Marker",
    "MarkerArray",
    "MenuEntry",
    "MeshFile",
    "UVCoordinate",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "ImageMarker": "_image_marker",
        "InteractiveMarker": "_interactive_marker",
        "InteractiveMarkerControl": "_interactive_marker_control",
        "InteractiveMarkerFeedback": "_interactive_marker_feedback",
        "InteractiveMarkerInit": "_interactive_marker_init",
        "InteractiveMarkerPose": "_interactive_marker_pose",
        "InteractiveMarkerUpdate": "_interactive_marker_update",
        "Marker": "_marker",
        "MarkerArray": "_marker_array",
        "MenuEntry": "_menu_entry",
        "MeshFile": "_mesh_file",
        "UVCoordinate": "_uv_coordinate",
    },
)
