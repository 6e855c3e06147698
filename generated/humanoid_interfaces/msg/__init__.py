"""Messages of humanoid_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from humanoid_interfaces.msg._battery_status import BatteryStatus as BatteryStatus
    from humanoid_interfaces.msg._detected_object import DetectedObject as DetectedObject
    from humanoid_interfaces.msg._detected_object_array import DetectedObjectArray as DetectedObjectArray
    from humanoid_interfaces.msg._emergency_stop import EmergencyStop as EmergencyStop
    from humanoid_interfaces.msg._footstep import Footstep as Footstep
    from humanoid_interfaces.msg._footstep_plan import FootstepPlan as FootstepPlan
    from humanoid_interfaces.msg._gait_state import GaitState as GaitState
    from humanoid_interfaces.msg._stance import Stance as Stance

__all__ = [
    "BatteryStatus",
    "DetectedObject",
    "DetectedObjectArray",
    "EmergencyStop",
    "Footstep",
    "FootstepPlan",
    "GaitState",
    "Stance",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "BatteryStatus": "_battery_status",
        "DetectedObject": "_detected_object",
        "DetectedObjectArray": "_detected_object_array",
        "EmergencyStop": "_emergency_stop",
        "Footstep": "_footstep",
        "FootstepPlan": "_footstep_plan",
        "GaitState": "_gait_state",
        "Stance": "_stance",
    },
)
