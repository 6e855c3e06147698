"""Actions of humanoid_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from humanoid_interfaces.action._perform_dance import PerformDance as PerformDance
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_GetResult_Event as PerformDance_GetResult_Event,
    )
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_GetResult_Request as PerformDance_GetResult_Request,
    )
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_GetResult_Response as PerformDance_GetResult_Response,
    )
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_SendGoal_Event as PerformDance_SendGoal_Event,
    )
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_SendGoal_Request as PerformDance_SendGoal_Request,
    )
    from humanoid_interfaces.action._perform_dance import (
        PerformDance_SendGoal_Response as PerformDance_SendGoal_Response,
    )
    from humanoid_interfaces.action._walk_to import WalkTo as WalkTo
    from humanoid_interfaces.action._walk_to import WalkTo_GetResult_Event as WalkTo_GetResult_Event
    from humanoid_interfaces.action._walk_to import WalkTo_GetResult_Request as WalkTo_GetResult_Request
    from humanoid_interfaces.action._walk_to import WalkTo_GetResult_Response as WalkTo_GetResult_Response
    from humanoid_interfaces.action._walk_to import WalkTo_SendGoal_Event as WalkTo_SendGoal_Event
    from humanoid_interfaces.action._walk_to import WalkTo_SendGoal_Request as WalkTo_SendGoal_Request
    from humanoid_interfaces.action._walk_to import WalkTo_SendGoal_Response as WalkTo_SendGoal_Response

__all__ = [
    "PerformDance",
    "PerformDance_GetResult_Event",
    "PerformDance_GetResult_Request",
    "PerformDance_GetResult_Response",
    "PerformDance_SendGoal_Event",
    "PerformDance_SendGoal_Request",
    "PerformDance_SendGoal_Response",
    "WalkTo",
    "WalkTo_GetResult_Event",
    "WalkTo_GetResult_Request",
    "WalkTo_GetResult_Response",
    "WalkTo_SendGoal_Event",
    "WalkTo_SendGoal_Request",
    "WalkTo_SendGoal_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "PerformDance": "_perform_dance",
        "PerformDance_GetResult_Event": "_perform_dance",
        "PerformDance_GetResult_Request": "_perform_dance",
        "PerformDance_GetResult_Response": "_perform_dance",
        "PerformDance_SendGoal_Event": "_perform_dance",
        "PerformDance_SendGoal_Request": "_perform_dance",
        "PerformDance_SendGoal_Response": "_perform_dance",
        "WalkTo": "_walk_to",
        "WalkTo_GetResult_Event": "_walk_to",
        "WalkTo_GetResult_Request": "_walk_to",
        "WalkTo_GetResult_Response": "_walk_to",
        "WalkTo_SendGoal_Event": "_walk_to",
        "WalkTo_SendGoal_Request": "_walk_to",
        "WalkTo_SendGoal_Response": "_walk_to",
    },
)
