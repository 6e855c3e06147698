"""Balance and steps: from sensors to set-points of all joints."""

from __future__ import annotations

from typing import Any

from humanoid_interfaces.msg import EmergencyStop, FootstepPlan
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Trigger
from whole_body_controller._whole_body_controller_base import WholeBodyControllerBase
from whole_body_controller._whole_body_controller_parameters import ParametersError

from .. import data, messages
from ..controller import WholeBodyController as Controller
from ..external import load_model
from ..reference import GaitParameters
from .running import run

_LATE = 3  # control periods after which the controller goes by what it has
_STOPPED = "somebody called ~/stop"


class WholeBodyController(WholeBodyControllerBase):
    """Controls once all readings of a moment are there, or when they are overdue."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        values = self.parameters
        parameters = GaitParameters(
            com_height=values.balance.com_height,
            dcm_gain=values.balance.k_dcm,
            integral_gain=values.balance.k_integral,
            lift=values.step.lift,
            double_support=values.step.double_support_time,
        )
        self._period = round(values.control.period * data.SECOND)
        self._controller = Controller(
            load_model(self.parameters.model_file, self.parameters.joint_map), parameters, self._period
        )
        self._joints: data.JointStates | None = None
        self._imu: data.Imu | None = None
        self._odometry: data.Odometry | None = None
        self._done = -1  # stamp of the last tick
        self._plan_id = 0
        self._stopped = False
        self._mode: data.Mode | None = None

    def on_joint_states(self, message: JointState) -> None:
        """Take angles and velocities."""
        try:
            self._joints = messages.read_joint_states(message)
        except ValueError as error:
            self.get_logger().warning(f"/joint_states: {error}", throttle_duration_sec=1.0)
        self._tick_if_complete()

    def on_imu_data(self, message: Imu) -> None:
        """Take orientation and angular velocity."""
        self._imu = messages.read_imu(message)
        self._tick_if_complete()

    def on_odom(self, message: Odometry) -> None:
        """Take the estimate of the base."""
        self._odometry = messages.read_odometry(message)
        self._tick_if_complete()

    def on_footsteps_upcoming(self, message: FootstepPlan) -> None:
        """Follow new steps; the same ones again are a sign of life."""
        self._controller.heard("gait_planner", max(self._done, 0))
        if message.plan_id == self._plan_id:
            return
        self._plan_id = message.plan_id
        try:
            plan = messages.read_footstep_plan(message)
        except ValueError as error:
            self.get_logger().warning(f"plan {message.plan_id} is refused: {error}")
            return
        if self._stopped and plan.steps:
            self._stopped = False
            self._controller.resume()
        if why_not := self._controller.follow(plan):
            self.get_logger().warning(f"plan {plan.plan_id} is refused: {why_not}")

    def on_posture(self, message: JointState) -> None:
        """Bring the upper body to a posture."""
        try:
            why_not = self._controller.posture(messages.read_posture(message))
        except ValueError as error:
            why_not = str(error)
        if why_not:
            self.get_logger().warning(f"/posture: {why_not}", throttle_duration_sec=1.0)

    def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Obey before anything else."""
        self._controller.emergency_stop(messages.read_emergency_stop(message))

    def handle_stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """End the step in the air and stand, until there are new footsteps."""
        self._stopped = True
        self._controller.hold(_STOPPED)
        response.success = True
        return response

    def on_control_timer(self) -> None:
        """See that set-points go out where readings are overdue."""
        now = self.get_clock().now().nanoseconds
        if self._done >= 0 and now - self._done >= _LATE * self._period:
            self._tick(now)

    def _tick_if_complete(self) -> None:
        joints, imu, odometry = self._joints, self._imu, self._odometry
        if joints is None or imu is None or odometry is None:
            return
        if joints.stamp == imu.stamp == odometry.stamp != self._done:
            self._tick(joints.stamp)

    def _tick(self, now: int) -> None:
        if self._joints is None or self._imu is None:
            return
        self._done = now
        setpoints = self._controller.tick(now, self._joints, self._imu, self._odometry)
        self.publish_whole_body_position_controller_commands(messages.command(setpoints))
        state = self._controller.state()
        self.publish_gait_state(messages.gait_state(state))
        if state.mode is not self._mode:
            self._mode = state.mode
            if state.reason:
                self.get_logger().warning(f"{state.mode.name.lower().replace('_', ' ')}: {state.reason}")


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(WholeBodyController, args, ParametersError)


if __name__ == "__main__":
    main()
