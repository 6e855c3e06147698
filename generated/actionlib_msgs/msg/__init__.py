"""Messages of actionlib_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from actionlib_msgs.msg._goal_id import GoalID as GoalID
    from actionlib_msgs.msg._goal_status import GoalStatus as GoalStatus
    from actionlib_msgs.msg._goal_status_array import GoalStatusArray as GoalStatusArray

__all__ = [
    "GoalID",
    "GoalStatus",
    "GoalStatusArray",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "GoalID": "_goal_id",
        "GoalStatus": "_goal_status",
        "GoalStatusArray": "_goal_status_array",
    },
)
