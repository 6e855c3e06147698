"""The node inverse_kinematics_server: joint angles for a wanted pose, and what the head can look at."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from humanoid import data
from humanoid.kinematics.dynamics import RobotState
from humanoid.kinematics.footprint import IDENTITY, from_footprint
from humanoid.kinematics.head import HeadPose
from humanoid.kinematics.ik import FARTHEST, IkRequest, IkResult, IkStatus, InverseKinematics
from humanoid.robot.external import load_model
from humanoid.ros import messages
from humanoid.ros.latest import LatestJoints
from humanoid.ros.running import run
from humanoid.spatial import Array
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from sensor_msgs.msg import JointState

from inverse_kinematics_server._inverse_kinematics_server_base import InverseKinematicsServerBase
from inverse_kinematics_server._inverse_kinematics_server_parameters import ParametersError

_BASE, _FOOTPRINT = "base_link", "base_footprint"


class InverseKinematicsServer(InverseKinematicsServerBase):
    """Solves requests one after another; targets are in base_link, or in base_footprint as the legs are now."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        humanoid = load_model(self.parameters.model_file, self.parameters.joint_map)
        self._body = humanoid.body
        self._solver = InverseKinematics(humanoid)
        self._head = HeadPose(humanoid)
        self._legs = RobotState(humanoid)
        self._joints = LatestJoints(self, self._body)

    def on_joint_states(self, message: JointState) -> None:
        """Take the joint positions, for requests without a seed."""
        self._joints.put(message)

    def handle_solve_ik(self, request: SolveIK.Request, response: SolveIK.Response) -> SolveIK.Response:
        """Search for the angles of a chain."""
        begun = self._solve(request)
        response.status = int(begun.status)
        response.message = begun.message[:255]
        response.solution = _joints(begun.names, begun.positions)
        response.position_residual = begun.position_residual
        response.orientation_residual = begun.orientation_residual
        response.attempts = begun.attempts
        response.computing_time = messages.duration_of(begun.computing_time)
        return response

    def handle_check_head_pose(
        self, request: CheckHeadPose.Request, response: CheckHeadPose.Response
    ) -> CheckHeadPose.Response:
        """Check whether waist and head can reach the pose."""
        try:
            position, orientation = self._in_base(request.target)
        except ValueError as error:
            response.message = str(error)[:255]
            response.position_residual = response.orientation_residual = math.nan
            return response
        result = self._head.check(
            request.mode,
            position,
            orientation,
            request.position_tolerance,
            request.orientation_tolerance,
        )
        response.reachable = result.reachable
        response.message = result.message[:255]
        response.joints = _joints(result.names, result.positions)
        response.position_residual = result.position_residual
        response.orientation_residual = result.orientation_residual
        return response

    def _solve(self, request: SolveIK.Request) -> IkResult:
        try:
            position, orientation = self._in_base(request.target)
        except ValueError as error:
            return IkResult(IkStatus.UNKNOWN_FRAME, str(error))
        if len(request.seed.name) != len(request.seed.position):
            return IkResult(IkStatus.INVALID_REQUEST, "the seed needs one position for each name")
        values = self.parameters
        return self._solver.solve(
            IkRequest(
                chain=request.chain,
                position=position,
                orientation=orientation,
                seed=dict(zip(request.seed.name, request.seed.position, strict=True)),
                position_only=request.position_only,
                position_tolerance=request.position_tolerance or values.tolerance.position,
                orientation_tolerance=request.orientation_tolerance or values.tolerance.orientation,
                attempts=request.attempts or values.attempts,
                timeout=messages.nanoseconds(request.timeout) / data.SECOND or values.timeout,
                random_seed=request.random_seed,
            ),
            None if (present := self._joints.get()) is None else present.position,
        )

    def _in_base(self, target: PoseStamped) -> tuple[Array, Array]:
        """Position (3,) and quaternion (4,) of a target in base_link. Raises ValueError for other frames."""
        position = messages.numbers(target.pose.position)
        orientation = messages.numbers(target.pose.orientation)
        frame = messages.printable(target.header.frame_id)
        if frame in {"", _BASE}:
            return position, orientation
        if frame != _FOOTPRINT:
            raise ValueError(f"the target is in '{frame}'; I think in {_BASE} and {_FOOTPRINT}")
        present = self._joints.get()
        if not max(np.abs(position).max(), np.abs(orientation).max()) <= FARTHEST:
            return position, orientation  # which the solvers refuse
        if present is None:
            raise ValueError(f"nobody has reported joint states: without them, {_FOOTPRINT} is unknown")
        self._legs.set_posture(np.zeros(3), IDENTITY, present.position)
        return from_footprint([self._legs.sole(side) for side in (0, 1)], position, orientation)


def _joints(names: tuple[str, ...], positions: tuple[float, ...]) -> JointState:
    return JointState(name=list(names), position=list(positions))


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(InverseKinematicsServer, args, ParametersError)


if __name__ == "__main__":
    main()
