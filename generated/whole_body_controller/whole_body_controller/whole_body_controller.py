"""The node whole_body_controller: turns sensor values into set-points of all joints."""

from __future__ import annotations

from functools import partial
from typing import Any

from humanoid import data
from humanoid.control.controller import WholeBodyController as Controller
from humanoid.control.pace import Pace
from humanoid.control.plausible import imu_problem, joints_problem
from humanoid.control.reference import GaitParameters
from humanoid.robot.external import load_model
from humanoid.ros import messages
from humanoid.ros.balance import balance_state
from humanoid.ros.diagnostics import Health
from humanoid.ros.recent import Recent, leapt, misdated, newest_of_all
from humanoid.ros.running import run
from humanoid.simulation.safety import clock_problem
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger

from whole_body_controller._whole_body_controller_base import WholeBodyControllerBase
from whole_body_controller._whole_body_controller_parameters import ParametersError

_STATE_PERIOD = 20_000_000  # ns between gait states while nothing in them changes but numbers
_BALANCE_PERIOD = 40_000_000  # ns between messages about the balance, while somebody wants them
_LATE = 3  # readings, or control periods, after which the controller uses what it has
_LEAP = data.SECOND  # ns by which a clock goes wrong, because no control loop is as late as that
_POSTURE_LEASE = 500_000_000  # ns that a posture is valid: a dance sends one 50 times a second
_HALTED = {data.Mode.HOLDING, data.Mode.EMERGENCY_STOP}


class WholeBodyController(WholeBodyControllerBase):
    """Runs the controller once all readings of a moment have arrived, or when they are overdue."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        values = self.parameters
        parameters = GaitParameters(
            dcm_gain=values.balance.k_dcm,
            integral_gain=values.balance.k_integral,
            lift=values.step.lift,
        ).at_pace(Pace(values.walking_speed))
        self._period = round(values.control.period * data.SECOND)
        model = load_model(values.model_file, values.joint_map)
        timeout = round(values.control.input_timeout * data.SECOND)
        self._make_controller = partial(Controller, model, parameters, self._period, timeout)
        self._controller = self._make_controller()
        kinds = ("readings", "plans", "postures")
        self._health = Health("whole_body_controller: inputs", self.get_logger(), *kinds)
        self._joints = Recent[data.JointStates]()
        self._imu = Recent[data.Imu]()
        self._odometry = Recent[data.Odometry]()
        self._began = -1  # stamp of the first tick
        self._done = -1  # stamp of the last one
        self._answer: Float64MultiArray | None = None  # its command
        self._overdue = False  # newest readings at the last check
        self._plan_id = 0
        self._refused_id: int | None = None  # of the last plan that was refused
        self._posture: int | None = None  # when the last one arrived
        self._stop = data.EmergencyStop(active=False)
        self._stopped = False
        self._servos = ""  # why they hold the robot on their own
        self._released = False  # by the servos; the weight is not between the feet yet
        self._mode: data.Mode | None = None
        self._said: tuple[object, ...] = ()  # what other nodes use of the last gait state
        self._told = 0  # when
        self._shown = -_BALANCE_PERIOD  # when the balance was last told, or nobody wanted to know

    def on_joint_states(self, message: JointState) -> None:
        """Take angles and velocities."""
        try:
            joints = messages.read_joint_states(message, self._controller.model.body)
        except ValueError as error:
            self._health.takes("readings", f"/joint_states: {error}")
            return
        if self._health.takes("readings", joints_problem(joints, self._controller.model)):
            if joints.stamp == self._done and self._answer is not None:
                # The same moment again: the simulator missed the answer.
                self.publish_whole_body_position_controller_commands(self._answer)
            self._take(self._joints, joints.stamp, joints, "/joint_states")

    def on_imu_data(self, message: Imu) -> None:
        """Take orientation and angular velocity."""
        imu = messages.read_imu(message)
        if self._health.takes("readings", imu_problem(imu)):
            self._take(self._imu, imu.stamp, imu, "/imu/data")

    def on_odom(self, message: Odometry) -> None:
        """Take the estimate of the base."""
        odometry = messages.read_odometry(message)
        if self._health.takes("readings", self._controller.inputs.odometry_problem(odometry)):
            self._take(self._odometry, odometry.stamp, odometry, "/odom")

    def on_footsteps_upcoming(self, message: FootstepPlan) -> None:
        """Follow new steps; repeated ones are a sign of life."""
        self._controller.heard("gait_planner", max(self._done, 0))
        if message.plan_id in (self._plan_id, self._refused_id):
            return
        try:
            why_not = self._follow(messages.read_footstep_plan(message))
        except ValueError as error:
            why_not = str(error)
        if self._health.takes("plans", f"{message.plan_id}: {why_not}" if why_not else ""):
            self._plan_id, self._refused_id = message.plan_id, None
        else:
            self._refused_id = message.plan_id

    def on_posture(self, message: JointState) -> None:
        """Bring the upper body to a posture."""
        try:
            posture = messages.read_posture(message, self._controller.model.body)
            why_not = self._controller.posture(posture)
        except ValueError as error:
            posture, why_not = None, str(error)
        if self._health.takes("postures", why_not):
            self._posture = None if posture is None else self._done

    def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Obey the emergency stop before anything else."""
        self._stop = messages.read_emergency_stop(message)
        self._controller.emergency_stop(self._stop)

    def on_servos_standby(self, message: String) -> None:
        """Stand while the servos hold the robot: they release it once set-points would not move them."""
        if message.data != self._servos:  # it is repeated
            self._released = bool(self._servos and not message.data)
            self._servos = message.data

    def handle_stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """End the step in the air and stand until new footsteps arrive."""
        self._stopped = True
        self._controller.hold(data.STOP_CALLED)
        response.success = True
        return response

    def on_control_timer(self) -> None:
        """Make sure that set-points go out when readings are overdue."""
        now = self.get_clock().now().nanoseconds
        overdue = self._done >= 0 and _LATE * self._period <= now - self._done <= _LEAP
        if overdue and self._overdue:  # nothing has arrived since the last check either
            self._tick(now)
        self._overdue = overdue

    def on_diagnostics_timer(self) -> None:
        """Report what was refused."""
        state = self._controller.state()
        self.publish_diagnostics(self._health.report(state.stamp, state.reason))

    def _follow(self, plan: data.FootstepPlan) -> str:
        """Walk a plan; returns why not, or ""."""
        if problem := clock_problem(plan.stamp, max(self._done, 0), "it"):
            return problem
        if plan.steps and 0 < plan.stamp < self._began:
            # Its sender saw an earlier controller, which was at another point of its walk.
            return "it is older than this controller"
        if self._stopped and plan.steps:
            self._stopped = False
            self._controller.resume()
        return self._controller.follow(plan)

    def _take(self, topic: Recent[Any], stamp: int, reading: object, name: str) -> None:
        if not topic.put(stamp, reading):
            # Odometry follows the other two: where they go back, it does, too.
            others = (self._odometry, self._joints) if topic is self._odometry else (self._joints, self._imu)
            if leapt(*others):
                self._begin_anew()
            elif topic.newest != stamp:
                self._health.takes("readings", misdated(name, stamp, topic))
                return
        self._tick_if_complete()

    def _tick_if_complete(self) -> None:
        if self._odometry.newest < 0:
            return
        # Odometry that has been missing for a while is no longer awaited. What counts is how many readings
        # have arrived since: if all were held up alike, odometry is on its way.
        late = self._joints.count_since(self._odometry.newest) >= _LATE
        awaited = (self._joints, self._imu) if late else (self._joints, self._imu, self._odometry)
        stamp = newest_of_all(*awaited, after=self._done)
        if stamp is not None:
            self._tick(stamp)

    def _tick(self, now: int) -> None:
        joints, imu = self._joints.at_or_last(now), self._imu.at_or_last(now)
        if joints is None or imu is None:
            return
        self._overdue = False
        self._began = now if self._began < 0 else self._began
        self._done = now
        if self._posture is not None and now - self._posture > _POSTURE_LEASE:
            self._posture = None
            self._controller.posture(None)
            self.get_logger().warning("whoever sent postures is silent: back to standing")
        if self._servos:
            reason = messages.printable(self._servos)
            self._controller.hold(f"the servos hold the robot on their own: {reason}"[:255])
            self._controller.begin_here()
        elif self._released and self._controller.stepping.standing:
            self._released = False
            self._controller.resume()
        setpoints = self._controller.tick(now, joints, imu, self._odometry.at_or_last(now))
        self._answer = messages.command(setpoints)
        self.publish_whole_body_position_controller_commands(self._answer)
        self._tell()

    def _tell(self) -> None:
        """Publish what the robot does: at once when that changes, otherwise now and then."""
        state = self._controller.state()
        said = (state.mode, state.reason, state.stance.support, state.plan_id, state.footstep_index)
        if said != self._said or state.stamp - self._told >= _STATE_PERIOD:
            self._said, self._told = said, state.stamp
            self.publish_gait_state(messages.gait_state(state))
        if abs(state.stamp - self._shown) >= _BALANCE_PERIOD:
            self._shown = state.stamp
            self._show_balance()
        if state.mode is not self._mode:
            if state.reason:
                self.get_logger().warning(f"{state.mode.name.lower().replace('_', ' ')}: {state.reason}")
            elif self._mode in _HALTED:
                self.get_logger().info("the robot accepts commands again")
            self._mode = state.mode

    def _show_balance(self) -> None:
        """Publish how the robot keeps its balance, if anybody subscribes to that."""
        balance = self._controller.balance() if self.balance_publisher.get_subscription_count() else None
        if balance is not None:
            self.publish_balance(balance_state(balance))

    def _begin_anew(self) -> None:
        """Start again: time has gone back, because the simulator stood the robot up where it started."""
        self._controller = self._make_controller()
        self._controller.emergency_stop(self._stop)
        self._odometry = Recent()
        self._began, self._done, self._posture = -1, -1, None
        self._stopped, self._said = False, ()


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(WholeBodyController, args, ParametersError)


if __name__ == "__main__":
    main()
