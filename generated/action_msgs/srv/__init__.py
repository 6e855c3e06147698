"""Services of action_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from action_msgs.srv._cancel_goal import CancelGoal as CancelGoal
    from action_msgs.srv._cancel_goal import CancelGoal_Event as CancelGoal_Event
    from action_msgs.srv._cancel_goal import CancelGoal_Request as CancelGoal_Request
    from action_msgs.srv._cancel_goal import CancelGoal_Response as CancelGoal_Response

__all__ = [
    "CancelGoal",
    "CancelGoal_Event",
    "CancelGoal_Request",
    "CancelGoal_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "CancelGoal": "_cancel_goal",
        "CancelGoal_Event": "_cancel_goal",
        "CancelGoal_Request": "_cancel_goal",
        "CancelGoal_Response": "_cancel_goal",
    },
)
