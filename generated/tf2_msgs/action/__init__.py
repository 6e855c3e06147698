"""Actions of tf2_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from tf2_msgs.action._lookup_transform import LookupTransform as LookupTransform
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_GetResult_Event as LookupTransform_GetResult_Event,
    )
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_GetResult_Request as LookupTransform_GetResult_Request,
    )
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_GetResult_Response as LookupTransform_GetResult_Response,
    )
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_SendGoal_Event as LookupTransform_SendGoal_Event,
    )
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_SendGoal_Request as LookupTransform_SendGoal_Request,
    )
    from tf2_msgs.action._lookup_transform import (
        LookupTransform_SendGoal_Response as LookupTransform_SendGoal_Response,
    )

__all__ = [
    "LookupTransform",
    "LookupTransform_GetResult_Event",
    "LookupTransform_GetResult_Request",
    "LookupTransform_GetResult_Response",
    "LookupTransform_SendGoal_Event",
    "LookupTransform_SendGoal_Request",
    "LookupTransform_SendGoal_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "LookupTransform": "_lookup_transform",
        "LookupTransform_GetResult_Event": "_lookup_transform",
        "LookupTransform_GetResult_Request": "_lookup_transform",
        "LookupTransform_GetResult_Response": "_lookup_transform",
        "LookupTransform_SendGoal_Event": "_lookup_transform",
        "LookupTransform_SendGoal_Request": "_lookup_transform",
        "LookupTransform_SendGoal_Response": "_lookup_transform",
    },
)
