"""The node footstep_generation_server: plans footsteps, or returns the reason why there are none."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from humanoid import data
from humanoid.control.pace import Pace
from humanoid.planning.footsteps import PlanStatus, StepLimits, fitted, plan_footsteps, shorter
from humanoid.robot.body import load_body
from humanoid.robot.scene import GROUND
from humanoid.ros import messages
from humanoid.ros.running import run
from humanoid_interfaces.srv import PlanFootsteps

from footstep_generation_server._footstep_generation_server_base import FootstepGenerationServerBase
from footstep_generation_server._footstep_generation_server_parameters import ParametersError

_FRAMES = ("", "odom")


class FootstepGenerationServer(FootstepGenerationServerBase):
    """Answers requests with plans; it moves nothing."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._body = load_body(self.parameters.model_file, self.parameters.joint_map)

    def handle_plan_footsteps(
        self, request: PlanFootsteps.Request, response: PlanFootsteps.Response
    ) -> PlanFootsteps.Response:
        """Plan from the stance of the request."""
        for what, frame in (
            ("goal", request.goal.header.frame_id),
            ("stance", request.start.header.frame_id),
        ):
            if frame not in _FRAMES:
                response.status = int(PlanStatus.UNKNOWN_FRAME)
                response.message = f"the {what} is in '{frame}'; I plan in odom"[:255]
                return response
        if not 0 <= request.max_step_length < math.inf:
            response.status = int(PlanStatus.INVALID_REQUEST)
            response.message = (
                f"max_step_length is {request.max_step_length:g} m; it must be finite, 0 or more"
            )
            return response
        first_leg = None
        if request.first_leg:
            if request.first_leg not in (data.Leg.LEFT, data.Leg.RIGHT):
                response.status = int(PlanStatus.INVALID_REQUEST)
                response.message = f"there is no leg {request.first_leg}"
                return response
            first_leg = data.Leg(request.first_leg)
        try:
            start = messages.read_stance(request.start)
        except ValueError as error:
            response.status = int(PlanStatus.INVALID_REQUEST)
            response.message = f"the stance: {error}"[:255]
            return response
        x, y, yaw = messages.planar(request.goal.pose).tolist()
        result = plan_footsteps(
            start,
            (x, y, yaw),
            limits=self._limits(request),
            ground=replace(GROUND, half_size=self.parameters.distance_max),
            first_leg=first_leg,
        )
        response.status = int(result.status)
        response.message = result.message[:255]
        response.plan = messages.footstep_plan(result.plan, self.get_clock().now().nanoseconds)
        return response

    def _limits(self, request: PlanFootsteps.Request) -> StepLimits:
        """The limits of the parameters, reduced if the request asks for less."""
        step = self.parameters.step
        usual = StepLimits(
            backward=step.backward_max,
            sideways=step.sideways_max,
            turn=step.turn_max,
            trailing_turn=step.turn_max / 2,
            width=self.parameters.stance_width,
        ).at_pace(Pace(self.parameters.walking_speed))
        wanted = messages.nanoseconds(request.step_time) / data.SECOND or usual.step_time
        return shorter(fitted(replace(usual, step_time=wanted), self._body), request.max_step_length)


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(FootstepGenerationServer, args, ParametersError)


if __name__ == "__main__":
    main()
