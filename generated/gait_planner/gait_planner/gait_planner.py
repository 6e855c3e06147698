"""The node gait_planner: publishes footsteps in the order in which they are due."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Point, Twist, Vector3
from humanoid import data
from humanoid.control.pace import Pace
from humanoid.planning.footsteps import StepLimits, fitted
from humanoid.planning.gait import GaitPlanner as Planner
from humanoid.robot.body import load_body
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.running import run
from humanoid_interfaces.msg import FootstepPlan, GaitState
from std_msgs.msg import ColorRGBA
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from gait_planner._gait_planner_base import GaitPlannerBase
from gait_planner._gait_planner_parameters import ParametersError

_COLOURS = {
    data.Leg.LEFT: ColorRGBA(r=0.18, g=0.62, b=0.36, a=1.0),
    data.Leg.RIGHT: ColorRGBA(r=0.91, g=0.53, b=0.18, a=1.0),
}
_THICKNESS = 0.005  # m
_WALKING = "navigation_action_server, or whoever sent the plan under way, has been silent"
_STEERING = "teleop, or whoever sent velocities, has been silent"
_HALTED = {data.Mode.HOLDING, data.Mode.EMERGENCY_STOP, data.Mode.FALLEN}
_DEAF = {*_HALTED, data.Mode.DANCING}
_LEASE = 500_000_000  # ns that a velocity is valid, and a plan that was sent twice


class GaitPlanner(GaitPlannerBase):
    """Passes plans on, steers by velocity, and stops the robot."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        step, pace = self.parameters.step, Pace(self.parameters.walking_speed)
        limits = StepLimits(
            sideways=step.sideways_max,
            turn=step.turn_max,
            trailing_turn=step.turn_max / 2,
            width=self.parameters.stance_width,
        ).at_pace(pace)
        body = load_body(self.parameters.model_file, self.parameters.joint_map)
        self._foot = body.foot
        self._planner = Planner(fitted(limits, body), pace.double_support)
        self._upcoming = FootstepPlan()  # as last published
        self._asked = FootstepPlan()  # the last plan with steps
        self._walking = False  # whether the robot walks it
        self._deaf = ""  # why it obeys no velocity at present
        self._lease: tuple[str, int] | None = None  # whose next message is expected, and until when [ns]
        self._health = Health("gait_planner: commands", self.get_logger(), "plans", "velocities", "readings")

    def on_footsteps_plan(self, message: FootstepPlan) -> None:
        """Walk a plan, or stop if it has no steps."""
        plan = self._health.read("plans", "/footsteps/plan", messages.read_footstep_plan, message)
        if plan is None:
            return
        self._lease = None
        if not plan.steps:
            self._stop()
        elif message != self._asked:
            self._asked, self._walking = message, True
            self._planner.walk(plan)
        elif self._walking:
            self._lease = (_WALKING, self._now() + _LEASE)

    def on_humanoid_cmd_vel(self, message: Twist) -> None:
        """Walk at a velocity."""
        velocity = message.linear.x, message.linear.y, message.angular.z
        deaf = self._deaf if any(velocity) else ""
        if not self._health.takes("velocities", deaf or self._planner.velocity(*velocity)):
            return
        if any(velocity):
            self._walking, self._lease = False, (_STEERING, self._now() + _LEASE)
        elif not self._walking:
            self._lease = None

    def on_gait_state(self, message: GaitState) -> None:
        """Decide what to do next, each time that the controller reports its state."""
        state = self._health.read("readings", "/gait_state", messages.read_gait_state, message)
        if state is None:
            return
        self._deaf = ""
        if state.mode in _DEAF:
            why = f": {state.reason}" if state.reason else ""
            self._deaf = f"the robot is not steered in mode {state.mode.name.lower().replace('_', ' ')}{why}"
        plan = self._planner.update(state)
        walked = self._walking and state.footstep_index > self._asked.steps[-1].index
        if walked or state.mode in _HALTED:
            self._walking, self._lease = False, None
        if plan is not None:
            self._upcoming = messages.footstep_plan(plan, state.stamp)
            self.publish_footsteps_upcoming(self._upcoming)
            self.publish_markers(_markers(plan, self._foot, state.stamp))

    def handle_clear(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stop the robot."""
        self._stop()
        response.success = True
        return response

    def on_sign_of_life_timer(self) -> None:
        """Repeat the plan: whoever walks these steps must know that the planner is still alive."""
        self.publish_footsteps_upcoming(self._upcoming)
        if self._lease is not None and self._now() > self._lease[1]:
            self.get_logger().warning(f"{self._lease[0]} for {_LEASE / data.SECOND:g} s: the robot stops")
            self._stop()

    def on_diagnostics_timer(self) -> None:
        """Report what was refused."""
        self.publish_diagnostics(self._health.report(self._now()))

    def _stop(self) -> None:
        self._walking, self._lease = False, None
        self._planner.cancel()

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def _markers(plan: data.FootstepPlan, foot: tuple[float, float], stamp: int) -> MarkerArray:
    """The steps as boxes of a foot's length and width, after a marker that deletes all older ones."""
    markers = [Marker(header=messages.header(stamp, "odom"), action=Marker.DELETEALL)]
    size = Vector3(x=foot[0], y=foot[1], z=_THICKNESS)
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
