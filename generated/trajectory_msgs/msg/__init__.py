"""Messages of trajectory_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from trajectory_msgs.msg._joint_trajectory import JointTrajectory as JointTrajectory
    from trajectory_msgs.msg._joint_trajectory_point import JointTrajectoryPoint as JointTrajectoryPoint
    from trajectory_msgs.msg._multi_dof_joint_trajectory import (
        MultiDOFJointTrajectory as MultiDOFJointTrajectory,
    )
    from trajectory_msgs.msg._multi_dof_joint_trajectory_point import (
        MultiDOFJointTrajectoryPoint as MultiDOFJointTrajectoryPoint,
    )

__all__ = [
    "JointTrajectory",
    "JointTrajectoryPoint",
    "MultiDOFJointTrajectory",
    "MultiDOFJointTrajectoryPoint",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "JointTrajectory": "_joint_trajectory",
        "JointTrajectoryPoint": "_joint_trajectory_point",
        "MultiDOFJointTrajectory": "_multi_dof_joint_trajectory",
        "MultiDOFJointTrajectoryPoint": "_multi_dof_joint_trajectory_point",
    },
)
