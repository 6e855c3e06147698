"""The node footstep_planner: a path to footsteps, and a velocity only as far as the way is free."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist
from humanoid import data
from humanoid.control.pace import Pace
from humanoid.planning.following import SHARP_TURN, TURN, blocked_step, steps_to_last_line
from humanoid.planning.footsteps import PlanStatus, StepLimits, fitted, shorter
from humanoid.planning.steering import Ahead, free_ahead
from humanoid.robot.body import load_body
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.grids import read_occupancy_grid, read_path
from humanoid.ros.running import run
from humanoid_interfaces.msg import GaitState
from humanoid_interfaces.srv import FollowPath, PlanFootsteps
from nav_msgs.msg import OccupancyGrid

from footstep_planner._footstep_planner_base import FootstepPlannerBase
from footstep_planner._footstep_planner_parameters import ParametersError

_FRAMES = ("", "odom")
_SHORT = 0.18  # m


class FootstepPlanner(FootstepPlannerBase):
    """Answers requests with plans, and stops the joystick in front of obstacles."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        values = self.parameters
        self._pace = Pace(values.walking_speed)
        body = load_body(values.model_file, values.joint_map)
        self._limits = fitted(StepLimits().at_pace(self._pace), body)
        self._gait: data.GaitState | None = None
        self._health = Health("footstep_planner: inputs", self.get_logger(), "readings", "maps", "velocities")
        self._points = np.zeros((0, 2))

    async def on_map(self, message: OccupancyGrid) -> None:
        """Take where obstacles are."""
        grid = self._health.read("maps", "/map", read_occupancy_grid, message)
        if grid is not None:
            self._points = grid.occupied()

    async def on_gait_state(self, message: GaitState) -> None:
        """Remember where the feet are."""
        self._gait = (
            self._health.read("readings", "/gait_state", messages.read_gait_state, message) or self._gait
        )

    async def on_teleop_velocity(self, message: Twist) -> None:
        """Let a velocity through if the next steps at it are free; otherwise stop."""
        velocity = message.linear.x, message.linear.y, message.angular.z
        problem = "" if np.isfinite(velocity).all() else "/teleop/velocity holds a number that is not finite"
        if not self._health.takes("velocities", problem):
            return
        if self._gait is not None and len(self._points) and any(velocity):
            centre = self._gait.stance.centre
            values = self.parameters
            ahead = Ahead(values.horizon, values.clearance, self._pace.double_support)
            if not free_ahead(centre, velocity, self._points, self._limits, ahead):
                self.get_logger().warning("stopped: an obstacle is in the way", throttle_duration_sec=2.0)
                message = Twist()
        self.publish_humanoid_cmd_vel(message)

    async def handle_follow_path(
        self, request: FollowPath.Request, response: FollowPath.Response
    ) -> FollowPath.Response:
        """Plan the steps along a path: round its corners here, on its last line by /plan_footsteps."""
        try:
            self._check(request)
            places, yaw = read_path(request.path)
        except ValueError as error:
            response.status = int(PlanStatus.INVALID_REQUEST)
            response.message = str(error)[:255]
            return response
        # Long steps cut corners: where they come too near to something, shorter ones may not, or those of a
        # body that turns on the spot first.
        short = min(request.max_step_length or _SHORT, _SHORT)
        for longest, turn in ((request.max_step_length, TURN), (short, TURN), (short, SHARP_TURN)):
            await self._follow(request, places, yaw, longest, turn, response)
            if response.status != int(PlanStatus.BLOCKED):
                break
        return response

    async def _follow(
        self,
        request: FollowPath.Request,
        places: tuple[tuple[float, float], ...],
        yaw: float,
        longest: float,
        turn: float,
        response: FollowPath.Response,
    ) -> None:
        """Fill in the response for steps of a length, and turns on the spot from an angle on."""
        limits = shorter(self._limits, longest)
        start = messages.read_stance(request.start)
        leg = data.Leg(request.first_leg) if request.first_leg else None
        steps, stance = steps_to_last_line(start, places, limits, leg, request.first_index, turn)
        index = request.first_index + len(steps)
        asked = PlanFootsteps.Request(
            start=messages.stance(stance, messages.nanoseconds(request.start.header.stamp)),
            goal=messages.stamped(0, messages.planar_pose(*places[-1], yaw)),
            first_leg=int((steps[-1].leg.other if steps else leg) or 0),
            max_step_length=longest,
        )
        try:
            rest = await self.call_plan_footsteps(asked, timeout_sec=self.parameters.service_timeout)
        except TimeoutError as error:
            response.status, response.message = int(PlanStatus.UNKNOWN), str(error)[:255]
            return
        if rest.status == int(PlanStatus.PLANNED):
            try:
                plan = messages.read_footstep_plan(rest.plan)
            except ValueError as error:
                response.status, response.message = int(PlanStatus.UNKNOWN), f"/plan_footsteps: {error}"
                return
            steps += [replace(step, index=index + number) for number, step in enumerate(plan.steps)]
        elif not (rest.status == int(PlanStatus.ALREADY_THERE) and steps):
            response.status, response.message = rest.status, rest.message
            return
        if problem := blocked_step(steps, self._points, start.centre, limits):
            response.status, response.message = int(PlanStatus.BLOCKED), problem[:255]
            return
        response.status, response.message = int(PlanStatus.PLANNED), ""
        plan = data.FootstepPlan(0, tuple(steps), (*places[-1], yaw))
        response.plan = messages.footstep_plan(plan, self.get_clock().now().nanoseconds)

    @staticmethod
    def _check(request: FollowPath.Request) -> None:
        """Raise ValueError if a request cannot be planned."""
        for what, frame in (
            ("path", request.path.header.frame_id),
            ("stance", request.start.header.frame_id),
        ):
            if frame not in _FRAMES:
                raise ValueError(f"the {what} is in '{frame}'; I plan in odom")
        if request.first_leg not in (0, data.Leg.LEFT, data.Leg.RIGHT):
            raise ValueError(f"there is no leg {request.first_leg}")
        messages.check_count("first_index", request.first_index)
        messages.read_stance(request.start)
        if not 0 <= request.max_step_length < np.inf:
            raise ValueError(
                f"max_step_length is {request.max_step_length:g} m; it must be finite, 0 or more"
            )


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(FootstepPlanner, args, ParametersError)


if __name__ == "__main__":
    main()
