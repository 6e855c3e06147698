"""Services of humanoid_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from humanoid_interfaces.srv._add_two_ints import AddTwoInts as AddTwoInts
    from humanoid_interfaces.srv._add_two_ints import AddTwoInts_Event as AddTwoInts_Event
    from humanoid_interfaces.srv._add_two_ints import AddTwoInts_Request as AddTwoInts_Request
    from humanoid_interfaces.srv._add_two_ints import AddTwoInts_Response as AddTwoInts_Response
    from humanoid_interfaces.srv._check_head_pose import CheckHeadPose as CheckHeadPose
    from humanoid_interfaces.srv._check_head_pose import CheckHeadPose_Event as CheckHeadPose_Event
    from humanoid_interfaces.srv._check_head_pose import CheckHeadPose_Request as CheckHeadPose_Request
    from humanoid_interfaces.srv._check_head_pose import CheckHeadPose_Response as CheckHeadPose_Response
    from humanoid_interfaces.srv._detect_objects import DetectObjects as DetectObjects
    from humanoid_interfaces.srv._detect_objects import DetectObjects_Event as DetectObjects_Event
    from humanoid_interfaces.srv._detect_objects import DetectObjects_Request as DetectObjects_Request
    from humanoid_interfaces.srv._detect_objects import DetectObjects_Response as DetectObjects_Response
    from humanoid_interfaces.srv._plan_footsteps import PlanFootsteps as PlanFootsteps
    from humanoid_interfaces.srv._plan_footsteps import PlanFootsteps_Event as PlanFootsteps_Event
    from humanoid_interfaces.srv._plan_footsteps import PlanFootsteps_Request as PlanFootsteps_Request
    from humanoid_interfaces.srv._plan_footsteps import PlanFootsteps_Response as PlanFootsteps_Response
    from humanoid_interfaces.srv._solve_ik import SolveIK as SolveIK
    from humanoid_interfaces.srv._solve_ik import SolveIK_Event as SolveIK_Event
    from humanoid_interfaces.srv._solve_ik import SolveIK_Request as SolveIK_Request
    from humanoid_interfaces.srv._solve_ik import SolveIK_Response as SolveIK_Response

__all__ = [
    "AddTwoInts",
    "AddTwoInts_Event",
    "AddTwoInts_Request",
    "AddTwoInts_Response",
    "CheckHeadPose",
    "CheckHeadPose_Event",
    "CheckHeadPose_Request",
    "CheckHeadPose_Response",
    "DetectObjects",
    "DetectObjects_Event",
    "DetectObjects_Request",
    "DetectObjects_Response",
    "PlanFootsteps",
    "PlanFootsteps_Event",
    "PlanFootsteps_Request",
    "PlanFootsteps_Response",
    "SolveIK",
    "SolveIK_Event",
    "SolveIK_Request",
    "SolveIK_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "AddTwoInts": "_add_two_ints",
        "AddTwoInts_Event": "_add_two_ints",
        "AddTwoInts_Request": "_add_two_ints",
        "AddTwoInts_Response": "_add_two_ints",
        "CheckHeadPose": "_check_head_pose",
        "CheckHeadPose_Event": "_check_head_pose",
        "CheckHeadPose_Request": "_check_head_pose",
        "CheckHeadPose_Response": "_check_head_pose",
        "DetectObjects": "_detect_objects",
        "DetectObjects_Event": "_detect_objects",
        "DetectObjects_Request": "_detect_objects",
        "DetectObjects_Response": "_detect_objects",
        "PlanFootsteps": "_plan_footsteps",
        "PlanFootsteps_Event": "_plan_footsteps",
        "PlanFootsteps_Request": "_plan_footsteps",
        "PlanFootsteps_Response": "_plan_footsteps",
        "SolveIK": "_solve_ik",
        "SolveIK_Event": "_solve_ik",
        "SolveIK_Request": "_solve_ik",
        "SolveIK_Response": "_solve_ik",
    },
)
