"""The whole-body controller: follows footsteps and keeps its balance, 250 times a second.

It sees only messages: joint states, IMU, odometry, and requests of other nodes. It has its own copy of the
model for kinematics and gravity, as a real robot's controller has robot_description.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..data import (
    BalanceState,
    EmergencyStop,
    FootstepPlan,
    GaitState,
    Imu,
    JointCommand,
    JointStates,
    Mode,
    Odometry,
    Posture,
    Stance,
    Support,
)
from ..kinematics.dynamics import RobotState, natural_frequency, world_velocity
from ..kinematics.legs import Legs
from ..robot.model import PERIOD, HumanoidModel
from ..robot.table import LEGS
from ..spatial import Array, cross, quaternion_of, rotation_vector, rotation_z, vector_of
from . import balance, effort
from .fitting import fitted
from .inputs import LATE, LEASE, Inputs, Leases
from .posture import level, standing
from .prediction import Prediction
from .reference import GaitParameters, Sample
from .stepping import Stepping
from .support import support_polygon
from .trunk import Trunk
from .upper_body import UpperBody

_FALLEN_HEIGHT = 0.68  # of base_link, as a share of the legs' length
_RECOVERY = 1_000_000_000  # ns without a fault until the robot takes commands again
_MADE_UP = 5  # missed ticks in a row that the reference catches up with
# rad/s that a joint's set-point moves at most. Ordinary walks stay below it. A foot that lands away from
# where the pelvis is would need four times as much in one tick, and a lead that large is out of every
# joint's range.
_JOINT_SPEED = 20.0
_UPRIGHT, _STILL = 0.05, 0.05  # rad of the trunk's lean and m/s of the centre of mass of a robot at rest
_BLEND = 4.0  # 1 / share of a swing in which the leg changes from the wanted pelvis to the measured one


class WholeBodyController:
    """Turns sensor messages into set-points of all servos."""

    def __init__(
        self,
        model: HumanoidModel,
        parameters: GaitParameters | None = None,
        period: int = PERIOD,
        input_timeout: int = LATE,
    ) -> None:
        """Stand; `period`, and `input_timeout`, the age at which a reading counts as missing, are in ns."""
        self.model = model
        self.parameters = fitted(parameters or GaitParameters(), model)
        self._period = period * 1e-9
        self._omega = natural_frequency(self.parameters.com_height)
        self.stepping = Stepping(self.parameters, self._omega, self._period, model.sole)
        self.inputs = Inputs(model, input_timeout)
        self._leases = Leases()
        self._legs = Legs(model)
        self._state = RobotState(model)
        self._planned = RobotState(
            model
        )  # the posture of the last set-points, for where its centre of mass is
        self._feedback = balance.DcmFeedback(self.parameters, self._period)
        self._joints = standing(model, self.stepping.feet, self.parameters)[0]
        self._command = self._joints.copy()
        self._upper = UpperBody(model)
        self._trunk = Trunk(model)
        self._fallen_height = _FALLEN_HEIGHT * model.body.leg_length
        self._started = self._begins = False
        self._reason = ""
        self._fault: int | None = None  # when the fault that the robot holds for was last present
        self._stop = EmergencyStop(active=False)
        self._fallen = False
        self._stamp = 0
        self._elapsed = self._period  # since the last tick, seconds
        self.error = np.zeros(2)  # of the DCM at the last tick, metres
        self._prediction = Prediction(self._omega, self._period)
        self._zmp: Array | None = None  # where the soles had to press at the last tick (2,)

    def follow(self, plan: FootstepPlan) -> str:
        """Walk on these footsteps from the next tick on; returns why not, or ""."""
        return self._halted or self.stepping.follow(plan)

    def posture(self, wanted: Posture | None) -> str:
        """Bring waist, head, arms and pelvis to a posture, or back to standing; returns why not, or ""."""
        if wanted is not None and (problem := self._upper.problem(wanted)):
            self.inputs.refusals.not_finite += 1
            return problem
        if wanted is not None and (why_not := self._halted or self._upper.out_of_reach(wanted)):
            return why_not
        self._upper.asked = wanted
        return ""

    def emergency_stop(self, status: EmergencyStop) -> None:
        """Obey the emergency stop: bring both feet to the ground and stand still until it is lifted."""
        if status.active and not self._stop.active:
            self._halt()
        self._stop = status

    def heard(self, node: str, now: int, lease: int = LEASE) -> None:
        """Note a sign of life of a node: a walk is broken off when none follows within the lease [ns]."""
        self._leases.heard(node, now, lease)

    def hold(self, reason: str) -> None:
        """Take a safe stance and accept no more commands until `resume`."""
        if not self._reason:
            self._reason = reason
            self._halt()

    def resume(self) -> None:
        """Accept commands again after `hold`."""
        self._reason = ""
        self._fault = None

    def begin_here(self) -> None:
        """Stand from wherever the feet are at the next tick: until then somebody else moves the robot."""
        self._started = False
        self._trunk = Trunk(self.model)
        self._prediction = Prediction(self._omega, self._period)
        self._feedback.reset()

    @property
    def mode(self) -> Mode:
        """The present mode of the controller."""
        if self._fallen:
            return Mode.FALLEN
        if self._stop.active:
            return Mode.EMERGENCY_STOP
        if self._reason:
            return Mode.HOLDING
        if self._upper.asked is not None:
            return Mode.DANCING
        if self.stepping.standing:
            return Mode.STANDING
        return Mode.WALKING if len(self.stepping.steps) > 1 else Mode.STOPPING

    @property
    def at_rest(self) -> bool:
        """Whether the robot stands, and has nothing left of a push or a hasty landing to make up for."""
        upright = float(np.abs(self._trunk.lean).max()) < _UPRIGHT
        return self.stepping.standing and upright and math.hypot(*self._state.com_velocity[:2]) < _STILL

    def state(self) -> GaitState:
        """The state of the controller at the last tick; the feet are where it measured them."""
        stance = self.stepping.stance
        feet = (self._state.planar_sole(0), self._state.planar_sole(1)) if self._started else stance.feet
        support = Support.NONE if self._fallen else stance.support
        return GaitState(
            self._stamp,
            self.mode,
            self._why,
            Stance(support, feet),
            self.stepping.plan_id,
            self.stepping.index,
            self.stepping.sample.phase,
        )

    def balance(self) -> BalanceState | None:
        """How the robot kept its balance at the last tick; None if it did not balance yet."""
        if self._zmp is None or self._fallen:
            return None
        swing = self.stepping.sample.swing
        swinging = swing.leg.side if swing else None
        carrying = [self._state.planar_sole(side) for side in (0, 1) if side != swinging]
        com = self._state.com
        capture = com[:2] + self._state.com_velocity[:2] / self._omega
        support = support_polygon(carrying, self.model.sole)
        return BalanceState(self._stamp, com.copy(), capture, self._zmp, support)

    def tick(self, now: int, joints: JointStates, imu: Imu, odometry: Odometry | None) -> JointCommand:
        """The set-points that answer the newest readings, at a moment of simulated time.

        Readings that are not numbers are refused and counted. Without odometry the controller computes its
        pose from its own legs and takes a safe stance. Without joint states or IMU it can only keep the last
        set-points.
        """
        elapsed = round((now - self._stamp) * 1e-9 / self._period) if self._started else 1
        self._elapsed = min(max(elapsed, 1), _MADE_UP + 1) * self._period
        self._stamp = now
        readings = self.inputs.take(now, joints, imu, odometry, self.state())
        self._look_for_faults(now)
        if readings is not None:
            self._sense(*readings)
            self._command = self._limp(readings[0]) if self._fallen else self._balance()
        return JointCommand(now, self._command.copy())

    @property
    def _halted(self) -> str:
        """The reason why the robot accepts no commands now, or ""."""
        if self.mode not in (Mode.HOLDING, Mode.EMERGENCY_STOP, Mode.FALLEN):
            return ""
        return f"{self.mode.name.lower().replace('_', ' ')}: {self._why}"

    def _look_for_faults(self, now: int) -> None:
        """Hold if a reading or a node is missing, until it has been back for a while."""
        silent = self._leases.problem(now)
        problem = self.inputs.problem or (silent if self.stepping.steps else "")
        if problem and (self._fault is not None or not self._reason):
            self._fault = now
            self.hold(problem)
        elif self._fault is not None and (silent or not self.stepping.standing):
            self._fault = now
        elif self._fault is not None and now - self._fault > _RECOVERY:
            self.resume()

    @property
    def _why(self) -> str:
        if self._fallen:
            return "the robot has fallen"
        if self._stop.active:
            return f"{self._stop.source}: {self._stop.reason}"
        return self._reason

    def _halt(self) -> None:
        self._upper.asked = None
        self.stepping.land_now()

    def _sense(self, joints: JointStates, imu: Imu, odometry: Odometry) -> None:
        """Adopt the robot's state, with its speed when the servos obey; begin from where its feet are.

        A posture is not predicted: a foot that lands stops at once.
        """
        state = self._state
        velocity = world_velocity(odometry.orientation, odometry.linear_velocity)
        state.set_posture(odometry.position, odometry.orientation, joints.position)
        standing = self.stepping.sample.swing is None
        velocity[:2] += self._prediction.gained(state.com[:2], velocity[:2], standing)
        state.set_motion(velocity, odometry.angular_velocity, joints.velocity)
        state.compute_dynamics()
        self._begins = not self._started
        if self._begins:
            self._started = True
            self.stepping.stand([state.planar_sole(side) for side in (0, 1)], state.com[:2])
            self._joints = joints.position.copy()
            # The robot may stand higher or lower than it will walk: it goes there slowly.
            floor = min(state.sole(side)[0][2] for side in (0, 1))
            self._upper.squat = self.parameters.com_height - float(state.com[2] - floor)
        lowest = min(state.sole(side)[0][2] for side in (0, 1))
        self._fallen = self._fallen or odometry.position[2] - lowest < self._fallen_height

    def _balance(self) -> Array:
        """One tick of walking or standing: set-points (joints,)."""
        state, stepping, parameters = self._state, self.stepping, self.parameters
        soles = [state.planar_sole(side) for side in (0, 1)]
        for _ in range(round(self._elapsed / self._period) - 1):
            # Readings were lost or late: the robot moved on without them.
            if stepping.next().last_of_swing:
                stepping.touchdown(soles)
        sample = stepping.next()
        dcm = state.com[:2] + state.com_velocity[:2] / self._omega
        self.error = dcm - (stepping.com + stepping.velocity / self._omega)
        stepping.keep_near(state.com[:2])
        stepping.adjust(self.error)
        stance = sample.swing.leg.other.side if sample.swing else None
        height = parameters.com_height - self._upper.squat
        zmp = self._feedback.zmp(sample.zmp, self.error)
        load = balance.distribute(zmp, soles, stance, self.model.sole, parameters)
        targets = stepping.targets()
        heading = rotation_z((targets[0][0][2] + targets[1][0][2]) / 2)
        axes = heading[:2, :2]
        beyond = axes.T @ (zmp - load.zmp) if stance is None else np.zeros(2)
        made_up = axes @ self._trunk.turn(beyond, self._elapsed)
        self._prediction.press(load.zmp + made_up)
        force = effort.wanted_force(state, load.zmp + made_up, self._omega, height)
        turning = self._trunk.accelerations(heading, state.base[1])
        motion = effort.Motion(state, force, stepping.accelerations(), turning)
        load = balance.distribute(motion.pressure_point(force), soles, stance, self.model.sole, parameters)
        self._zmp = load.zmp
        torque = motion.torques(force, load)
        way = _JOINT_SPEED * self._elapsed
        wanted = self._inverse_kinematics(sample, targets, heading, height)
        joints = np.clip(wanted, self._joints - way, self._joints + way)
        # The first set-points may be far from where the joints are: they are a place to go to, not a speed.
        velocity = 0.0 if self._begins else (joints - self._joints) / self._elapsed
        self._joints = joints
        if sample.last_of_swing:
            stepping.touchdown(soles)
        # A servo pushes with kp (command - position) - kv velocity: this makes it push with `torque` on the
        # way.
        return joints + (torque + self.model.kv * velocity) / self.model.kp

    def _inverse_kinematics(
        self, sample: Sample, targets: Sequence[tuple[Array, float]], heading: Array, height: float
    ) -> Array:
        """Joint positions that put soles (planar poses, heights) and centre of mass where they should be.

        `heading` is the rotation of a pelvis that is level.
        """
        rotation = self._kept(heading @ rotation_vector(np.array([*self._trunk.lean, 0.0])))
        self._planned.set_posture(np.zeros(3), quaternion_of(rotation), self._joints)
        com, axis = self.stepping.com, rotation_z(targets[0][0][2])[:2, 0]
        ahead = [float((foot[:2] - com) @ axis) for foot, _ in targets]
        speed = float(self.stepping.velocity @ axis)
        upright = self._upper.move(self._trunk.straight(self._joints), ahead, speed, self._elapsed)
        joints = self._trunk.bent(upright)
        pelvis = (np.array([com[0], com[1], height]) - self._planned.com, rotation)
        for side, (foot, lifted) in enumerate(targets):
            swinging = sample.swing is not None and sample.swing.leg.side == side
            base = self._towards_measured(pelvis, min(1.0, _BLEND * sample.phase)) if swinging else pelvis
            leg = LEGS[side]
            joints[leg] = self._legs.solve(side, base, level(foot, lifted), self._joints[leg])
        return joints

    def _kept(self, rotation: Array) -> Array:
        """A wanted rotation of the pelvis, turned against the tilt that it is measured to have beyond it."""
        up = self._state.base[1][:, 2]
        tilt = self.parameters.tilt_gain * cross(up, rotation[:, 2])
        return rotation_vector(tilt) @ rotation

    def _towards_measured(self, pelvis: tuple[Array, Array], share: float) -> tuple[Array, Array]:
        """A pelvis between the wanted and the measured one, where a swinging leg really starts."""
        position, rotation = self._state.base
        turn = rotation_vector(share * vector_of(pelvis[1].T @ rotation))
        return pelvis[0] + share * (position - pelvis[0]), pelvis[1] @ turn

    def _limp(self, joints: JointStates) -> Array:
        """Set-points at the present joint positions: only damping, for a robot that lies on the floor."""
        return np.clip(joints.position, self.model.lower, self.model.upper)
