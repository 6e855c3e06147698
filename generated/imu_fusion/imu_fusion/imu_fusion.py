"""The node imu_fusion: estimates where the robot is, from joint angles, IMU and the loads on the feet."""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped, WrenchStamped
from humanoid import data
from humanoid.control.plausible import imu_problem, joints_problem, wrench_problem
from humanoid.robot.external import load_model
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.recent import Recent, leapt, misdated, newest_of_all
from humanoid.ros.running import run
from humanoid.sensing.estimator import StateEstimator
from humanoid_interfaces.msg import GaitState
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from imu_fusion._imu_fusion_base import ImuFusionBase
from imu_fusion._imu_fusion_parameters import ParametersError

_APART = 0.02  # m between a sole as the controller reports it and as it is by the estimate


class ImuFusion(ImuFusionBase):
    """Estimates once all readings of a moment have arrived, in whatever order they come."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._model = load_model(self.parameters.model_file, self.parameters.joint_map)
        self._estimator = StateEstimator(
            self._model,
            velocity_time=self.parameters.velocity_time_constant,
            position_time=self.parameters.position_time_constant,
        )
        self._joints = Recent[data.JointStates]()
        self._imu = Recent[data.Imu]()
        self._wrenches = (Recent[data.FootWrench](), Recent[data.FootWrench]())
        self._gait: data.GaitState | None = None
        self._done = -1  # stamp of the last estimate
        self._answer: Odometry | None = None  # the last estimate
        self._placed = False  # whether the controller has reported where the soles are
        self._health = Health("imu_fusion: inputs", self.get_logger(), "readings")

    def on_joint_states(self, message: JointState) -> None:
        """Take angles and velocities."""
        try:
            joints = messages.read_joint_states(message, self._model.body)
        except ValueError as error:
            self._health.takes("readings", f"/joint_states: {error}")
            return
        if self._health.takes("readings", joints_problem(joints, self._model)):
            if joints.stamp == self._done and self._answer is not None:
                self.publish_odom(self._answer)  # the same moment again: somebody missed the answer
            self._take(self._joints, joints.stamp, joints, "/joint_states")

    def on_imu_data(self, message: Imu) -> None:
        """Take orientation, angular velocity and acceleration."""
        imu = messages.read_imu(message)
        if self._health.takes("readings", imu_problem(imu)):
            self._take(self._imu, imu.stamp, imu, "/imu/data")

    def on_l_foot_wrench(self, message: WrenchStamped) -> None:
        """Take the load on the left foot."""
        self._on_wrench(0, message)

    def on_r_foot_wrench(self, message: WrenchStamped) -> None:
        """Take the load on the right foot."""
        self._on_wrench(1, message)

    def on_gait_state(self, message: GaitState) -> None:
        """Take which foot is planned to carry the robot."""
        gait = self._health.read("readings", "/gait_state", messages.read_gait_state, message)
        if gait is not None:
            self._gait = gait
            if not self._placed:
                self._place(gait.stance.feet)

    def handle_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Start again with the feet at the origin, unless somebody walks by the present estimate."""
        if self._gait is not None:
            response.message = "whole_body_controller relies on this estimate: reset the simulator instead"
            return response
        self._estimator.restart()
        self._done = -1
        response.success = True
        return response

    def on_diagnostics_timer(self) -> None:
        """Report what was refused."""
        self.publish_diagnostics(self._health.report(max(self._done, 0)))

    def _on_wrench(self, side: int, message: WrenchStamped) -> None:
        wrench = messages.read_wrench(message)
        if self._health.takes("readings", wrench_problem(wrench)):
            self._take(self._wrenches[side], wrench.stamp, wrench, "the wrench of a foot")

    def _take(self, topic: Recent[Any], stamp: int, reading: object, name: str) -> None:
        if not topic.put(stamp, reading):
            if leapt(self._joints, self._imu, *self._wrenches):
                self._done = -1  # the simulator started again
                self._estimator.restart()
            elif topic.newest != stamp:
                self._health.takes("readings", misdated(name, stamp, topic))
                return
        self._estimate()

    def _estimate(self) -> None:
        stamp = newest_of_all(self._joints, self._imu, *self._wrenches, after=self._done)
        if stamp is None:
            return
        self._done = stamp
        joints, imu = self._joints.at(stamp), self._imu.at(stamp)
        left, right = (wrench.at(stamp) for wrench in self._wrenches)
        estimate = self._estimator.update(joints, imu, (left, right), self._gait)
        self._answer = messages.odometry(estimate)
        self.publish_odom(self._answer)
        if self.parameters.publish_tf:
            self.publish_tf(TFMessage(transforms=[self._transform(estimate)]))

    def _place(self, feet: tuple[np.ndarray, np.ndarray]) -> None:
        """Continue from where the soles are, if the robot was controlled before this node started."""
        self._placed = True
        own = self._estimator.stance.feet
        apart = max(float(np.abs(foot - mine)[:2].max()) for foot, mine in zip(feet, own, strict=True))
        if self._done < 0 or apart > _APART:
            self._estimator.restart([np.array([x, y, 0.0]) for x, y, _ in feet])

    def _transform(self, estimate: data.Odometry) -> TransformStamped:
        transform = TransformStamped(
            header=messages.header(estimate.stamp, self.parameters.odom_frame),
            child_frame_id=self.parameters.base_frame,
        )
        transform.transform.translation = messages.vector(estimate.position)
        transform.transform.rotation = messages.quaternion(estimate.orientation)
        return transform


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(ImuFusion, args, ParametersError)


if __name__ == "__main__":
    main()
