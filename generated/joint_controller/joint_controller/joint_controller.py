"""The node joint_controller: the guard between commands and servos."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from geometry_msgs.msg import WrenchStamped
from humanoid import data
from humanoid.control.plausible import imu_problem, joints_problem, wrench_problem
from humanoid.control.standby import Standby
from humanoid.robot.external import load_model
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.recent import Recent, leapt, misdated, newest_of_all
from humanoid.ros.running import run
from humanoid.sensing.joints import JointCollector
from humanoid.simulation.safety import LATEST, CommandGate
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import SetBool

from joint_controller._joint_controller_base import JointControllerBase
from joint_controller._joint_controller_parameters import ParametersError

_COMMANDER = "whole_body_controller"
_HELD = "somebody called ~/hold"


class JointController(JointControllerBase):
    """Passes good commands on as they come, and answers readings itself when no good command does.

    The other readings are kept as messages, and read only when the robot has to stand on its own.
    """

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Load the model, and create all entities."""
        model = self._model = load_model(self.parameters.model_file, self.parameters.joint_map)
        self._names = list(model.body.joints)
        self._gate = CommandGate(model.lower, model.upper)
        self._standby = Standby(model)
        self._health = Health("joint_controller: commands", self.get_logger(), "readings")
        self._collector = JointCollector(self._names)
        self._joints = Recent[data.JointStates]()
        self._imu = Recent[Imu]()
        self._wrenches = (Recent[WrenchStamped](), Recent[WrenchStamped]())
        self._done = -1  # stamp of the readings that were answered last
        self._answer: JointState | None = None  # the set-points for them
        self._said = ""
        return super().on_configure(state)

    def on_whole_body_position_controller_commands(self, message: Float64MultiArray) -> None:
        """Pass set-points on, unless they are bad or the robot stands on its own."""
        newest = self._joints.newest
        command = messages.read_command(message, newest)
        # A command may overtake the readings that it answers.
        now = command.stamp if newest < command.stamp <= newest + LATEST else newest
        if self._gate.accept(command, now):
            self._standby.commanded(now, command.position)
            if not self._standby.reason:
                self._answer_with(command)
        elif command.answers and command.stamp == self._done and self._answer is not None:
            self.publish_joint_commands(self._answer)  # the same moment again: somebody missed the answer
        else:
            text = f"set-points refused ({self._gate.refusals.total} so far): {self._gate.reason}"
            self.get_logger().warning(text, throttle_duration_sec=1.0)
            if command.answers and command.stamp == newest > self._done and not self._standby.reason:
                # The servos keep their last ones. Without an answer, time in lockstep would wait for another.
                self._answer_with(data.JointCommand(newest, self._gate.setpoints(newest)))

    def on_joint_encoders(self, message: JointState) -> None:
        """Keep what a driver measures."""
        stamp = messages.nanoseconds(message.header.stamp)
        values = [np.asarray(part) for part in (message.position, message.velocity, message.effort)]
        try:
            states = self._collector.take(stamp, message.name, *values)
        except ValueError as error:
            self._health.takes("readings", f"/joint_encoders: {error}")
            return
        if states is not None and self._health.takes("readings", joints_problem(states, self._model)):
            self._take(self._joints, stamp, states)

    def on_imu_data(self, message: Imu) -> None:
        """Keep the orientation of the pelvis."""
        self._take(self._imu, messages.nanoseconds(message.header.stamp), message)

    def on_l_foot_wrench(self, message: WrenchStamped) -> None:
        """Keep the load on the left foot."""
        self._take(self._wrenches[0], messages.nanoseconds(message.header.stamp), message)

    def on_r_foot_wrench(self, message: WrenchStamped) -> None:
        """Keep the load on the right foot."""
        self._take(self._wrenches[1], messages.nanoseconds(message.header.stamp), message)

    def handle_hold(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Stand on its own, or stop that."""
        self._standby.hold(_HELD if request.data else "")
        response.success = True
        return response

    def on_diagnostics_timer(self) -> None:
        """Report what was refused."""
        self.publish_servos_standby(String(data=self._said))  # in case somebody else has said otherwise
        stamp = max(self._joints.newest, 0)
        report = self._health.report(stamp, self._standby.reason, asdict(self._gate.refusals))
        self.publish_diagnostics(report)

    def _take(self, topic: Recent[Any], stamp: int, reading: Any) -> None:
        if not topic.put(stamp, reading):
            if leapt(self._joints, self._imu, *self._wrenches):
                self._begin_anew()
            elif topic.newest != stamp:
                self._health.takes("readings", misdated("a reading", stamp, topic))
                return
        if self._standby.is_due(self._joints.newest):
            self._stand()

    def _stand(self) -> None:
        """Answer the newest complete readings."""
        now = newest_of_all(self._joints, self._imu, *self._wrenches, after=self._done)
        if now is None:
            return
        sensors = self._sensors(now)
        problem = imu_problem(sensors.imu) or next(filter(None, map(wrench_problem, sensors.wrenches)), "")
        if not self._health.takes("readings", problem):
            return
        command = self._standby.tick(now, sensors)
        if command is not None:
            self._answer_with(command)
        self._tell()

    def _sensors(self, stamp: int) -> data.Sensors:
        """The readings of a moment."""
        left, right = (messages.read_wrench(wrench.at(stamp)) for wrench in self._wrenches)
        imu = messages.read_imu(self._imu.at(stamp))
        return data.Sensors(stamp, self._joints.at(stamp), imu, (left, right), (False, False))

    def _answer_with(self, command: data.JointCommand) -> None:
        self._done = command.stamp
        self._answer = messages.joint_commands(command, self._names)
        self.publish_joint_commands(self._answer)

    def _tell(self) -> None:
        """Say that the robot stands on its own, or does no longer."""
        if self._standby.reason == self._said:
            return
        self._said = self._standby.reason
        self.publish_servos_standby(String(data=self._said))
        if self._said:
            text = f"the servos hold the robot on their own: {self._said} from {_COMMANDER}"
            self.get_logger().error(text)
        else:
            self.get_logger().info(f"{_COMMANDER} controls the servos again")

    def _begin_anew(self) -> None:
        """Start again: time has gone back."""
        self._gate.reset(self._gate.setpoints(0))
        self._standby.reset()
        self._done, self._answer = -1, None
        self._tell()


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(JointController, args, ParametersError)


if __name__ == "__main__":
    main()
