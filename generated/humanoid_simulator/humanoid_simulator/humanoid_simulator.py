"""The node humanoid_simulator: the humanoid in MuJoCo, the only source of time and of sensor values."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped, WrenchStamped
from humanoid import data
from humanoid.control.posture import start
from humanoid.robot import table
from humanoid.robot.description import describe_robot
from humanoid.robot.external import load_model
from humanoid.robot.obstacles import Solid, random_solids, solids_of
from humanoid.robot.urdf import write_urdf
from humanoid.ros import images, messages
from humanoid.ros.diagnostics import UNANSWERED, Health
from humanoid.ros.markers import obstacle_markers
from humanoid.ros.running import run
from humanoid.seeds import generator
from humanoid.simulation.battery import BatteryPack
from humanoid.simulation.rendering import HeadCamera, RenderingError
from humanoid.simulation.sim import QUIET, Noise, Simulator
from humanoid.simulation.waiting import Waiting
from humanoid_interfaces.msg import ObstacleMotion, ObstacleTouch
from rcl_interfaces.msg import SetParametersResult
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, JointState
from std_msgs.msg import Bool, Empty, String
from std_srvs.srv import SetBool, Trigger
from tf2_msgs.msg import TFMessage

from humanoid_simulator._humanoid_simulator_base import HumanoidSimulatorBase
from humanoid_simulator._humanoid_simulator_parameters import HumanoidSimulatorParameters, ParametersError

_LOST = 0.1  # s that paced lockstep may lag behind the wall clock before the lost time is dropped
_MADE_UP = 10  # periods that physics may lag behind in real time
_PUSH = 0.1  # s
_STRONGEST = 1000.0  # N
_BATTERY_PERIOD = 1.0  # s
_COMMANDER = "joint_controller"


class HumanoidSimulator(HumanoidSimulatorBase):
    """Steps when the set-points of the moment have arrived (lockstep), or with the wall clock.

    In lockstep a run repeats exactly: nothing in it depends on the wall clock, unless no set-points arrive
    for as long as `patience`.
    """

    _camera: HeadCamera | None = None  # also of a node that a bad parameter ends before it has begun

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._period = round(self.parameters.control_period * data.SECOND)
        try:
            self._load(self._solids(self.parameters.obstacles, self.parameters.random_obstacles.free))
        except ValueError as error:
            raise ParametersError(str(error)) from None
        self.add_on_set_parameters_callback(self._refuse_obstacles)
        self._battery = BatteryPack()
        self._health = Health(
            "humanoid_simulator: commands", self.get_logger(), "set-points", "pushes", "moves"
        )
        self._unanswered = 0  # steps without set-points
        self._paused = False
        self._blind = False  # no image can be drawn here
        self._losses = generator(self.parameters.seed, "camera")
        self._begin()
        self.publish_robot_description(
            String(data=describe_robot(self._model) if self.parameters.model_file else write_urdf())
        )
        self.publish_tf_static(TFMessage(transforms=[_identity("map", "odom")]))

    def destroy_node(self) -> None:
        """Release OpenGL too."""
        if self._camera is not None:
            self._camera.close()
        super().destroy_node()

    def on_parameters_changed(self, parameters: HumanoidSimulatorParameters) -> None:
        """Follow the wall clock at the new speed from here on."""
        self._restart_wall()

    @property
    def stamp(self) -> int:
        """Simulated time [ns]."""
        return self.simulator.stamp

    def on_joint_commands(self, message: JointState) -> None:
        """Give the servos new set-points; in lockstep, time waits for them."""
        command = self._health.read(
            "set-points", "/joint_commands", messages.read_joint_commands, message, self._model.body.joints
        )
        if command is None or not self._health.takes("set-points", self.simulator.protect(command)):
            return
        self._commanded = True
        self._waiting.answered(time.monotonic())
        if command.stamp == self.stamp:
            self._answered = True
            if self.parameters.lockstep and not self._paused:
                self._step_in_time()

    def on_push(self, message: WrenchStamped) -> None:
        """Push the torso."""
        force = messages.numbers(message.wrench.force)
        possible = np.abs(force).max() <= _STRONGEST  # false for NaN too
        if self._health.takes("pushes", "" if possible else f"more than {_STRONGEST:g} N along an axis"):
            self.simulator.push(force, _PUSH)

    def on_move_obstacle(self, message: ObstacleMotion) -> None:
        """Put an obstacle elsewhere."""
        why = self.simulator.obstacles.move(message.name, message.position.x, message.position.y)
        if self._health.takes("moves", why):
            self.publish_obstacles(obstacle_markers(self.simulator.obstacles.solids, self.stamp))

    def on_head_camera_trigger(self, message: Empty) -> None:
        """Take a picture."""
        self._take_picture()

    def handle_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Start again at time 0, between the obstacles that the parameters ask for by now."""
        solids = self._solids(self.parameters.obstacles, self.parameters.random_obstacles.free)
        if solids != self._loaded:
            self._load(solids)
        self._begin()
        response.success = True
        return response

    def handle_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Stop time, or let it run on."""
        self._paused = request.data
        self._restart_wall()
        response.success = True
        return response

    def handle_step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Run one control period."""
        response.success = self._paused
        response.message = "" if self._paused else "time is not paused"
        if self._paused:
            self._step()
        return response

    def on_pace_timer(self) -> None:
        """Advance time if nothing else does: by the wall clock, or because nobody answers."""
        if self._paused:
            return
        if not self._commanded:
            # The robot is not left on its own before there is a node that balances it.
            if self._waiting.is_over(time.monotonic(), self.parameters.patience):
                self._publish()  # nobody was there to receive it the first time
            self._restart_wall()
        elif not self.parameters.lockstep:
            behind = int((time.monotonic() - self._wall) * data.SECOND) - self.stamp
            # A few late periods are made up for, two at a time. More than that is lost, and the log says so.
            if behind > _MADE_UP * self._period:
                self.get_logger().warning("physics lags behind the wall clock", throttle_duration_sec=5.0)
                self._restart_wall()
            for _ in range(min(max(behind // self._period, 0), 2)):
                self._step()
        elif self._answered:
            self._step_in_time()
        elif self._waiting.is_over(time.monotonic(), self.parameters.patience):
            self._waiting.alone = True
            self._unanswered += 1
            text = f"no set-points from {_COMMANDER}: time goes on without them"
            self.get_logger().warning(text, throttle_duration_sec=5.0)
            self._step()

    def _begin(self) -> None:
        posture, base = start(self._model)
        self.simulator.reset(posture, base)
        self._contacts: tuple[bool, bool] | None = None
        self._due: dict[str, int] = {}  # things that are due periodically, and when they are due next
        self._sensors: data.Sensors | None = None
        self._commanded = False
        self._waiting = Waiting()
        self._restart_wall()
        self.publish_obstacles(obstacle_markers(self.simulator.obstacles.solids, self.stamp))
        self._publish()

    def _load(self, solids: tuple[Solid, ...]) -> None:
        """Build the world: the robot, and obstacles round it."""
        self._loaded = solids
        self._model = load_model(self.parameters.model_file, self.parameters.joint_map, solids)
        noise = Noise() if self.parameters.noise else QUIET
        self.simulator = Simulator(self._model, self.parameters.seed, noise, self._period, solids)
        if self._camera is not None:
            self._camera.close()  # it draws the world before
            self._camera = None

    def _solids(self, texts: Sequence[str], free: Sequence[float]) -> tuple[Solid, ...]:
        """The obstacles that the parameters ask for. Raises ValueError."""
        try:
            solids = solids_of(texts)
        except ValueError as error:
            raise ValueError(f"obstacles: {error}") from None
        places = [*free, *(part for s in solids for part in (s.x, s.y))]
        if len(places) % 2:
            raise ValueError("random_obstacles.free: expected x and y of each place: an even count")
        values = self.parameters
        x, y, to_x, to_y = values.random_obstacles.area
        pairs = list(zip(places[::2], places[1::2], strict=True))
        return solids + random_solids(values.seed, values.random_obstacles.count, (x, y, to_x, to_y), pairs)

    def _refuse_obstacles(self, parameters: list[Parameter]) -> SetParametersResult:
        """Refuse obstacles that cannot be put there at the next reset."""
        asked = {parameter.name: parameter.value for parameter in parameters}
        texts = asked.get("obstacles", self.parameters.obstacles)
        try:
            self._solids(texts, asked.get("random_obstacles.free", self.parameters.random_obstacles.free))
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _restart_wall(self) -> None:
        """Align the wall clock with the present simulated time."""
        speed = self.parameters.speed if self.parameters.lockstep else 1.0
        self._wall = time.monotonic() - self.stamp / data.SECOND / (speed or 1.0)

    def _step_in_time(self) -> None:
        """Step once the wall clock allows it; lost time is not made up for.

        No other callback runs meanwhile. Otherwise the order of events, and so the run, would depend on that
        clock.
        """
        if speed := self.parameters.speed:
            ahead = self.stamp / data.SECOND / speed - (time.monotonic() - self._wall)
            if ahead < -_LOST:
                self._restart_wall()
            time.sleep(max(ahead, 0.0))
        self._step()

    def _step(self) -> None:
        self.simulator.step()
        for touch in self.simulator.obstacles.look(self.stamp):
            self.publish_touches(
                ObstacleTouch(
                    header=messages.header(touch.stamp, "odom"), obstacle=touch.obstacle, link=touch.link
                )
            )
        self._sensors = None
        self._publish()

    def _publish(self) -> None:
        """Publish all sensor values of this moment, and then the time."""
        sensors = self._sensors = self._sensors or self.simulator.sensors()
        self._answered = False
        self._waiting.begin(time.monotonic())
        self.publish_joint_encoders(messages.joint_states(sensors.joints, self._model.body.joints))
        self.publish_imu_data(messages.imu(sensors.imu))
        self.publish_l_foot_wrench(messages.wrench(sensors.wrenches[0], "l_ankle"))
        self.publish_r_foot_wrench(messages.wrench(sensors.wrenches[1], "r_ankle"))
        if sensors.contacts != self._contacts:
            self._contacts = sensors.contacts
            self.publish_l_foot_contact(Bool(data=sensors.contacts[0]))
            self.publish_r_foot_contact(Bool(data=sensors.contacts[1]))
        if self.parameters.ground_truth and self._is_time_for(
            "ground truth", self.parameters.ground_truth_period
        ):
            self.publish_ground_truth_odom(messages.odometry(self.simulator.truth()))
            self.publish_ground_truth_stance(messages.stance(self.simulator.sole_truth(), self.stamp))
        reading = self._battery.update(sensors.joints)
        if self._is_time_for("battery", _BATTERY_PERIOD):
            self.publish_battery_state(
                BatteryState(
                    header=messages.header(reading.stamp, ""),
                    voltage=reading.voltage,
                    current=reading.current,
                    percentage=reading.charge,
                    temperature=reading.temperature,
                    present=True,
                    power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
                    power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LION,
                )
            )
            counts = {UNANSWERED: self._unanswered}
            self.publish_diagnostics(self._health.report(self.stamp, others=counts))
        if self._is_time_for("clock", self.parameters.clock_period):
            self.publish_clock(Clock(clock=messages.time_of(self.stamp)))

    def _is_time_for(self, what: str, period: float) -> bool:
        """Whether something with this period [s of simulated time] is due now."""
        due = self._due.get(what, self.stamp)
        if self.stamp < due:
            return False
        self._due[what] = due + max(round(period * data.SECOND), self._period)
        return True

    def _take_picture(self) -> None:
        """Send the picture of this moment to the camera's driver, if one can be drawn and it is not lost."""
        if self._blind:
            return
        values = self.parameters.camera
        try:
            self._camera = self._camera or HeadCamera(self._model, values.width, values.height)
        except RenderingError as error:
            self._blind = True
            self.get_logger().warning(f"the robot is blind: {error}")
            return
        if self._losses.random() >= values.loss:
            header = messages.header(self.stamp, table.CAMERA_FRAME)
            self.publish_head_camera_sensor(images.image(header, self._camera.picture(self.simulator)))


def _identity(parent: str, child: str) -> TransformStamped:
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = parent
    transform.header.stamp = Time()
    transform.transform.rotation.w = 1.0
    return transform


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(HumanoidSimulator, args, ParametersError)


if __name__ == "__main__":
    main()
