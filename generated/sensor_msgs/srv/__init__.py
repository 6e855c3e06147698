"""Services of sensor_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from sensor_msgs.srv._set_camera_info import SetCameraInfo as SetCameraInfo
    from sensor_msgs.srv._set_camera_info import SetCameraInfo_Event as SetCameraInfo_Event
    from sensor_msgs.srv._set_camera_info import SetCameraInfo_Request as SetCameraInfo_Request
    from sensor_msgs.srv._set_camera_info import SetCameraInfo_Response as SetCameraInfo_Response

__all__ = [
    "SetCameraInfo",
    "SetCameraInfo_Event",
    "SetCameraInfo_Request",
    "SetCameraInfo_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "SetCameraInfo": "_set_camera_info",
        "SetCameraInfo_Event": "_set_camera_info",
        "SetCameraInfo_Request": "_set_camera_info",
        "SetCameraInfo_Response": "_set_camera_info",
    },
)
