"""Footsteps in the order in which they are due."""

from __future__ import annotations

from typing import Any

from gait_planner._gait_planner_base import GaitPlannerBase
from gait_planner._gait_planner_parameters import ParametersError
from geometry_msgs.msg import Point, Twist, Vector3
from humanoid_interfaces.msg import FootstepPlan, GaitState
from std_msgs.msg import ColorRGBA
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from .. import data, messages, robot
from ..gait import GaitPlanner as Planner
from .running import run

_COLOURS = {
    data.Leg.LEFT: ColorRGBA(r=0.18, g=0.62, b=0.36, a=1.0),
    data.Leg.RIGHT: ColorRGBA(r=0.91, g=0.53, b=0.18, a=1.0),
}
_THICKNESS = 0.005  # m


class GaitPlanner(GaitPlannerBase):
    """Passes plans on, steers by velocity, stops."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._planner = Planner(double_support=self.parameters.step.double_support_time)
        self._plan = data.FootstepPlan(0, (), (0.0, 0.0, 0.0))

    def on_footsteps_plan(self, message: FootstepPlan) -> None:
        """Walk a plan, or stop where it has no steps."""
        try:
            plan = messages.read_footstep_plan(message)
        except ValueError as error:
            self.get_logger().warning(f"/footsteps/plan: {error}")
            return
        if plan.steps:
            self._planner.walk(plan)
        else:
            self._planner.cancel()

    def on_humanoid_cmd_vel(self, message: Twist) -> None:
        """Walk at a velocity."""
        self._planner.velocity(message.linear.x, message.linear.y, message.angular.z)

    def on_gait_state(self, message: GaitState) -> None:
        """Look what to do next, each time that the controller tells what it does."""
        state = messages.read_gait_state(message)
        plan = self._planner.update(state)
        if plan is not None:
            self._plan = plan
            self.publish_footsteps_upcoming(messages.footstep_plan(plan, state.stamp))
            self.publish_markers(_markers(plan, state.stamp))

    def handle_clear(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stop."""
        self._planner.cancel()
        response.success = True
        return response

    def on_sign_of_life_timer(self) -> None:
        """Say the same again: whoever walks on these steps must know that somebody still plans."""
        stamp = self.get_clock().now().nanoseconds
        self.publish_footsteps_upcoming(messages.footstep_plan(self._plan, stamp))


def _markers(plan: data.FootstepPlan, stamp: int) -> MarkerArray:
    """The steps as boxes, after all older ones are deleted."""
    markers = [Marker(header=messages.header(stamp, "odom"), action=Marker.DELETEALL)]
    size = Vector3(x=robot.FOOT_LENGTH, y=robot.FOOT_WIDTH, z=_THICKNESS)
    for step in plan.steps:
        pose = messages.planar_pose(step.x, step.y, step.yaw)
        pose.position = Point(x=step.x, y=step.y, z=_THICKNESS / 2)
        markers.append(
            Marker(
                header=messages.header(stamp, "odom"),
                ns="footsteps",
                id=step.index,
                type=Marker.CUBE,
                action=Marker.ADD,
                pose=pose,
                scale=size,
                color=_COLOURS[step.leg],
            )
        )
    return MarkerArray(markers=markers)


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(GaitPlanner, args, ParametersError)


if __name__ == "__main__":
    main()
