"""The node inverse_kinematics_server: joint angles for a wanted pose, and what the head can look at."""

from __future__ import annotations

import math
from typing import Any

from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from inverse_kinematics_server._inverse_kinematics_server_base import InverseKinematicsServerBase
from inverse_kinematics_server._inverse_kinematics_server_parameters import ParametersError
from sensor_msgs.msg import JointState

from .. import data
from ..kinematics.head import HeadPose
from ..kinematics.ik import IkRequest, IkResult, IkStatus, InverseKinematics
from ..robot.external import load_model
from ..ros import messages
from .running import run

_FRAMES = ("", "base_link")


class InverseKinematicsServer(InverseKinematicsServerBase):
    """Solves requests one after another; targets are in base_link."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        humanoid = load_model(self.parameters.model_file, self.parameters.joint_map)
        self._solver = InverseKinematics(humanoid)
        self._head = HeadPose(humanoid)
        self._joints: data.JointStates | None = None

    def on_joint_states(self, message: JointState) -> None:
        """Take the joint positions, for requests without a seed."""
        try:
            self._joints = messages.read_joint_states(message)
        except ValueError as error:
            self.get_logger().warning(f"/joint_states: {error}", throttle_duration_sec=1.0)

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
        frame = request.target.header.frame_id
        if frame not in _FRAMES:
            response.message = f"the target is in '{frame}'; I think in base_link"[:255]
            response.position_residual = response.orientation_residual = math.nan
            return response
        result = self._head.check(
            request.mode,
            messages.numbers(request.target.pose.position),
            messages.numbers(request.target.pose.orientation),
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
        frame = request.target.header.frame_id
        if frame not in _FRAMES:
            return IkResult(IkStatus.UNKNOWN_FRAME, f"the target is in '{frame}'; I think in base_link")
        if len(request.seed.name) != len(request.seed.position):
            return IkResult(IkStatus.INVALID_REQUEST, "the seed needs one position for each name")
        values = self.parameters
        return self._solver.solve(
            IkRequest(
                chain=request.chain,
                position=messages.numbers(request.target.pose.position),
                orientation=messages.numbers(request.target.pose.orientation),
                seed=dict(zip(request.seed.name, request.seed.position, strict=True)),
                position_only=request.position_only,
                position_tolerance=request.position_tolerance or values.tolerance.position,
                orientation_tolerance=request.orientation_tolerance or values.tolerance.orientation,
                attempts=request.attempts or values.attempts,
                timeout=messages.nanoseconds(request.timeout) / data.SECOND or values.timeout,
                random_seed=request.random_seed,
            ),
            None if self._joints is None else self._joints.position,
        )


def _joints(names: tuple[str, ...], positions: tuple[float, ...]) -> JointState:
    return JointState(name=list(names), position=list(positions))


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(InverseKinematicsServer, args, ParametersError)


if __name__ == "__main__":
    main()
