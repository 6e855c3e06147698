"""Services of lifecycle_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from lifecycle_msgs.srv._change_state import ChangeState as ChangeState
    from lifecycle_msgs.srv._change_state import ChangeState_Event as ChangeState_Event
    from lifecycle_msgs.srv._change_state import ChangeState_Request as ChangeState_Request
    from lifecycle_msgs.srv._change_state import ChangeState_Response as ChangeState_Response
    from lifecycle_msgs.srv._get_available_states import GetAvailableStates as GetAvailableStates
    from lifecycle_msgs.srv._get_available_states import GetAvailableStates_Event as GetAvailableStates_Event
    from lifecycle_msgs.srv._get_available_states import (
        GetAvailableStates_Request as GetAvailableStates_Request,
    )
    from lifecycle_msgs.srv._get_available_states import (
        GetAvailableStates_Response as GetAvailableStates_Response,
    )
    from lifecycle_msgs.srv._get_available_transitions import (
        GetAvailableTransitions as GetAvailableTransitions,
    )
    from lifecycle_msgs.srv._get_available_transitions import (
        GetAvailableTransitions_Event as GetAvailableTransitions_Event,
    )
    from lifecycle_msgs.srv._get_available_transitions import (
        GetAvailableTransitions_Request as GetAvailableTransitions_Request,
    )
    from lifecycle_msgs.srv._get_available_transitions import (
        GetAvailableTransitions_Response as GetAvailableTransitions_Response,
    )
    from lifecycle_msgs.srv._get_state import GetState as GetState
    from lifecycle_msgs.srv._get_state import GetState_Event as GetState_Event
    from lifecycle_msgs.srv._get_state import GetState_Request as GetState_Request
    from lifecycle_msgs.srv._get_state import GetState_Response as GetState_Response

__all__ = [
    "ChangeState",
    "ChangeState_Event",
    "ChangeState_Request",
    "ChangeState_Response",
    "GetAvailableStates",
    "GetAvailableStates_Event",
    "GetAvailableStates_Request",
    "GetAvailableStates_Response",
    "GetAvailableTransitions",
    "GetAvailableTransitions_Event",
    "GetAvailableTransitions_Request",
    "GetAvailableTransitions_Response",
    "GetState",
    "GetState_Event",
    "GetState_Request",
    "GetState_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "ChangeState": "_change_state",
        "ChangeState_Event": "_change_state",
        "ChangeState_Request": "_change_state",
        "ChangeState_Response": "_change_state",
        "GetAvailableStates": "_get_available_states",
        "GetAvailableStates_Event": "_get_available_states",
        "GetAvailableStates_Request": "_get_available_states",
        "GetAvailableStates_Response": "_get_available_states",
        "GetAvailableTransitions": "_get_available_transitions",
        "GetAvailableTransitions_Event": "_get_available_transitions",
        "GetAvailableTransitions_Request": "_get_available_transitions",
        "GetAvailableTransitions_Response": "_get_available_transitions",
        "GetState": "_get_state",
        "GetState_Event": "_get_state",
        "GetState_Request": "_get_state",
        "GetState_Response": "_get_state",
    },
)
