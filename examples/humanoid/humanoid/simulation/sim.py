"""The simulator: steps physics and reads sensors. It knows nothing about walking."""

from __future__ import annotations

import hashlib
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from ..data import SECOND, FootWrench, Imu, JointCommand, JointStates, Odometry, Sensors, Stance, Support
from ..robot.model import PERIOD, SERVO_DELAY, HumanoidModel
from ..robot.obstacles import Solid
from ..robot.table import SIDES
from ..seeds import generator
from ..spatial import Array, quaternion_of, yaw_of
from .inertial import MEMS, InertialErrors, InertialUnit
from .obstacles import Obstacles
from .safety import CommandGate

CONTACT_FORCE = 5.0  # N on a sole that count as contact


@dataclass(frozen=True, slots=True)
class Noise:
    """Errors of the sensors, with standard deviations for each reading; MuJoCo itself adds none."""

    inertial: InertialErrors | None = MEMS  # None: the IMU is exact, and knows its orientation
    position: float = 0.0005  # rad
    velocity: float = 0.02  # rad/s


QUIET = Noise(None, 0.0, 0.0)


class Simulator:
    """One robot on its floor. Only `step` advances time."""

    def __init__(
        self,
        model: HumanoidModel,
        seed: int = 0,
        noise: Noise = QUIET,
        period: int = PERIOD,
        solids: Sequence[Solid] = (),
    ) -> None:
        """Set up; `solids` are the obstacles that the model was loaded with."""
        self.model = model
        self.data = model.data()
        self.gate = CommandGate(model.lower, model.upper)
        self.obstacles = Obstacles(model.mj, self.data, solids)
        self._noise = noise
        self._seed = seed
        self._period = period
        self._steps = max(1, round(period / (model.mj.opt.timestep * SECOND)))
        self._pushes: list[tuple[int, Array]] = []
        self.reset()

    def reset(self, posture: Array | None = None, base: Array | None = None) -> None:
        """Start again at time 0, with joint positions (joints,) and base_link's position (3,), if given."""
        self.stamp = 0
        self._random = generator(self._seed, "sim")
        errors = self._noise.inertial
        self._imu = InertialUnit(errors, generator(self._seed, "imu")) if errors else None
        self._pushes.clear()
        mujoco.mj_resetData(self.model.mj, self.data)
        self.obstacles.reset()
        if posture is not None:
            self.data.qpos[self.model.qpos] = posture
            self.data.ctrl[self.model.actuators] = posture
        if base is not None:
            self.data.qpos[:3] = base
        self.gate.reset(self.data.qpos[self.model.qpos])
        first = self.gate.setpoints(0)
        self._on_the_way = deque(first for _ in range(round(SERVO_DELAY / self._period)))
        mujoco.mj_forward(self.model.mj, self.data)
        self._inertia = self._read("imu_angular_velocity"), self._read("imu_linear_acceleration")

    def apply(self, command: JointCommand) -> bool:
        """Give the servos new set-points; False if the command is refused and the last good one remains."""
        return self.gate.accept(command, self.stamp)

    def protect(self, command: JointCommand) -> str:
        """Make the servos follow this instead of any command; returns why they cannot, or ""."""
        problem = self.gate.impossible(command, self.stamp)
        if not problem:
            self.gate.protect(command.position)
        return problem

    def push(self, force: Array, duration: float) -> None:
        """Push the torso with a force (3,) in the world [N] for a time [s], from now on."""
        self._pushes.append((self.stamp + round(duration * SECOND), np.asarray(force, dtype=float)))

    def step(self) -> None:
        """Advance by one control period."""
        self._on_the_way.append(self.gate.setpoints(self.stamp))
        self.data.ctrl[self.model.actuators] = self._on_the_way.popleft()
        self._pushes = [push for push in self._pushes if push[0] > self.stamp]
        self.data.xfrc_applied[self.model.torso, :3] = sum((force for _, force in self._pushes), np.zeros(3))
        rate, acceleration = np.zeros(3), np.zeros(3)
        for number in range(self._steps):
            mujoco.mj_step(self.model.mj, self.data)
            # Sensors are from before the step: what accelerates in it, and what the last one led to.
            acceleration += self._read("imu_linear_acceleration")
            rate += self._read("imu_angular_velocity") if number else 0.0
        # Sensors and poses are from before the last step until they are computed again.
        mujoco.mj_forward(self.model.mj, self.data)
        rate += self._read("imu_angular_velocity")
        # The IMU takes the mean since the last moment. A foot that lands is felt for 2 ms; a sample now and
        # then would miss it, or take it for more than it was.
        self._inertia = rate / self._steps, acceleration / self._steps
        self.stamp += self._period

    def sensors(self) -> Sensors:
        """The sensor values of this moment, with noise. Each call draws new noise of the joints."""
        data, noise = self.data, self._noise
        draw = self._random.standard_normal
        joints = JointStates(
            self.stamp,
            data.qpos[self.model.qpos] + noise.position * draw(len(self.model.qpos)),
            data.qvel[self.model.dof] + noise.velocity * draw(len(self.model.qpos)),
            data.actuator_force[self.model.actuators].copy(),
        )
        left, right = (
            # The sensor measures the wrench of the foot on the leg.
            FootWrench(self.stamp, -self._read(f"{side}_foot_force"), -self._read(f"{side}_foot_torque"))
            for side in SIDES
        )
        touch = [float(self._read(f"{side}_foot_touch")[0]) > CONTACT_FORCE for side in SIDES]
        return Sensors(self.stamp, joints, self._inertial(), (left, right), (touch[0], touch[1]))

    def _inertial(self) -> Imu:
        rate, acceleration = self._inertia
        if self._imu is not None:
            return self._imu.read(self.stamp, rate, acceleration)
        w, x, y, z = self._read("imu_orientation")
        return Imu(self.stamp, np.array([x, y, z, w]), rate.copy(), acceleration.copy())

    def truth(self) -> Odometry:
        """True pose and velocity of base_link: for tests and pictures, not for controllers."""
        data = self.data
        rotation = data.xmat[self.model.base].reshape(3, 3)
        linear, angular = rotation.T @ data.qvel[:3], data.qvel[3:6].copy()
        return Odometry(self.stamp, data.qpos[:3].copy(), quaternion_of(rotation), linear, angular)

    def sole_truth(self) -> Stance:
        """The true poses of the soles."""
        feet = []
        for side in SIDES:
            site = self.model.frames[f"{side}_sole"]
            x, y, _ = self.data.site_xpos[site]
            feet.append(np.array([x, y, yaw_of(self.data.site_xmat[site].reshape(3, 3))]))
        touch = [float(self._read(f"{side}_foot_touch")[0]) > CONTACT_FORCE for side in SIDES]
        support = {(True, True): Support.BOTH, (True, False): Support.LEFT, (False, True): Support.RIGHT}
        return Stance(support.get((touch[0], touch[1]), Support.NONE), (feet[0], feet[1]))

    def hash(self) -> str:
        """SHA-256 over positions, velocities and sensors: equal runs have equal hashes."""
        digest = hashlib.sha256()
        for part in (self.data.qpos, self.data.qvel, self.data.sensordata):
            digest.update(part.tobytes())
        return digest.hexdigest()

    def _read(self, sensor: str) -> Array:
        return np.array(self.data.sensordata[self.model.sensors[sensor]])
