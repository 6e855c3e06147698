"""Estimates where the robot is, from its legs and IMU: a standing foot does not move, so the body does."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..data import FootWrench, GaitState, Imu, JointStates, Odometry, Stance, Support
from ..kinematics.dynamics import RobotState
from ..robot.model import GRAVITY, HumanoidModel
from ..spatial import Array, matrix_of, quaternion_of, rotation_vector

_LOAD_SMOOTHING = 0.3  # weight of a new reading in the estimate of how the weight is shared
# A foot bounces and slides as it lands. It has come to rest when it carries this share of the weight and this
# time [ns] has passed, or when it carries most of the weight.
_SETTLED, _SETTLING_TIME, _CARRIES = 0.2, 80_000_000, 0.6
# Seconds in which soles correct the tilt, and rad of it that they show at most: pushed, a robot stands on the
# edge of a foot.
_LEVELLING, _EDGE = 1.0, 0.02
_GAIT_VALID = 200_000_000  # ns after which a controller that is silent no longer lets its foot swing
_IDLE = 0.1  # share of the weight below which a foot does not count
_SWINGING = {Support.LEFT: 1, Support.RIGHT: 0}  # support: the side in the air


class StateEstimator:
    """Estimates pose and velocity of base_link in odom, from joint states, IMU and the feet's wrenches.

    Each foot has an anchor: where its sole stands. A foot that swings by the controller's plan is ignored,
    however early it touches the ground. A landed foot is ignored too until it carries weight, because it
    still slides. Its anchor is set then.

    The IMU's roll and pitch follow gravity as an accelerometer with a bias feels it. The soles that carry lie
    flat, and correct them. Nothing corrects the heading: it drifts with the gyroscope.

    `velocity_time` and `position_time` [s]: how fast the legs correct the integrated IMU.
    """

    def __init__(
        self, model: HumanoidModel, *, velocity_time: float = 0.03, position_time: float = 0.03
    ) -> None:
        self._velocity_time, self._position_time = velocity_time, position_time
        self._state = RobotState(model)
        self._anchors: list[Array] = []  # (3,) each
        self._share = 0.5  # of the weight on the left foot
        self._position = np.zeros(3)
        self._velocity = np.zeros(3)
        self._support = Support.BOTH
        self._landed = 0  # when it landed
        self._settling: int | None = None  # the side whose foot is in the air or has just landed
        self._level = np.zeros(3)  # rotation vector that corrects roll and pitch of the IMU
        self._idle = (False, False)  # whether a foot carries nothing
        self._weight = model.mass * GRAVITY
        self._stamp = 0
        self.refused = 0  # readings that were not finite numbers
        self._last = Odometry(0, *(np.full(size, np.nan) for size in (3, 4, 3, 3)))

    @property
    def stance(self) -> Stance:
        """Planar poses of both soles according to the last estimate."""
        return Stance(self._support, (self._state.planar_sole(0), self._state.planar_sole(1)))

    def restart(self, soles: Sequence[Array] | None = None, lifted: int | None = None) -> None:
        """Assume the soles at these points (3,), or side by side at the origin, at the next update.

        `lifted` is the side whose foot is in the air, if one is.
        """
        self._anchors = [point.copy() for point in soles] if soles is not None else []
        self._settling = lifted
        self._stamp = self._landed = 0

    def update(
        self, joints: JointStates, imu: Imu, wrenches: tuple[FootWrench, FootWrench], gait: GaitState | None
    ) -> Odometry:
        """Take the readings of one control tick and the controller's newest state; returns the new estimate.

        Readings that are not finite are refused and counted. The estimate is then the previous one, with its
        old stamp; if there is none, it is not finite either.
        """
        if not _finite(joints, imu, wrenches):
            self.refused += 1
            return self._last
        turned = rotation_vector(self._level) @ matrix_of(imu.orientation)
        orientation = quaternion_of(turned)
        self._state.set_posture(np.zeros(3), orientation, joints.position)
        self._state.set_motion(np.zeros(3), imu.angular_velocity, joints.velocity)
        relative = [self._state.sole(side)[0] for side in (0, 1)]
        first = self._stamp == 0
        if not self._anchors:
            middle = (relative[0] + relative[1]) / 2
            self._anchors = [point - middle for point in relative]
        self._weigh(joints.stamp, wrenches, gait)
        shares = (self._share, 1 - self._share)
        legs = sum(
            (s * (a - r) for s, a, r in zip(shares, self._anchors, relative, strict=True)), np.zeros(3)
        )
        speed = -sum((s * self._state.sole_velocity(side) for side, s in enumerate(shares)), np.zeros(3))
        if first:
            self._position, self._velocity = legs, speed
        else:
            elapsed = (joints.stamp - self._stamp) * 1e-9
            self._fuse(legs, speed, turned @ imu.linear_acceleration, elapsed)
            self._stand_level(elapsed)
        self._stamp = max(joints.stamp, 1)
        self._state.set_posture(self._position, orientation, joints.position)
        self._anchor()
        velocity = turned.T @ self._velocity
        self._last = Odometry(
            joints.stamp, self._position.copy(), orientation, velocity, imu.angular_velocity.copy()
        )
        return self._last

    def _weigh(self, now: int, wrenches: tuple[FootWrench, FootWrench], gait: GaitState | None) -> None:
        """The weight of each foot in the estimate: the load on it, but zero before it has settled."""
        support = Support.BOTH
        if gait is not None and now - gait.stamp <= _GAIT_VALID:
            support = gait.stance.support
        left, right = (max(0.0, float(wrench.force[2])) for wrench in wrenches)
        carried = left / (left + right) if left + right > 1.0 else 0.5
        if support in _SWINGING:
            self._settling, self._landed = _SWINGING[support], now
        elif self._settling is not None:
            on_it = (carried, 1 - carried)[self._settling]
            if on_it > _CARRIES or (on_it > _SETTLED and now - self._landed > _SETTLING_TIME):
                self._settling = None
        if self._settling is not None:
            self._share = float(self._settling)  # 1 while the right foot settles: all on the left one
        else:
            wanted = min(max((carried - _IDLE) / (1 - 2 * _IDLE), 0.0), 1.0)
            self._share += _LOAD_SMOOTHING * (wanted - self._share)
        self._idle = (carried < _IDLE and self._settling != 1, 1 - carried < _IDLE and self._settling != 0)
        stands = (right, left)[_SWINGING[support]] if support in _SWINGING else left + right
        if stands < _CARRIES * self._weight:
            self._idle = (True, True)  # it is falling onto its foot, which may still slide
        self._support = support

    def _stand_level(self, period: float) -> None:
        """Correct roll and pitch of the IMU's orientation: a sole that carries lies flat on the floor."""
        for side, share in enumerate((self._share, 1 - self._share)):
            if side == self._settling or self._idle[side]:
                continue
            x, y, _ = self._state.sole(side)[1][:, 2]
            way = share * period / _LEVELLING
            self._level += way * np.array([_within(y), _within(-x), 0.0])

    def _fuse(self, position: Array, velocity: Array, felt: Array, period: float) -> None:
        """Integrate the acceleration that was felt (3,), and pull the integrals towards the legs' values."""
        self._velocity = self._velocity + (felt - np.array([0.0, 0.0, GRAVITY])) * period
        legs = not all(self._idle)
        if legs:
            self._velocity += (1 - math.exp(-period / self._velocity_time)) * (velocity - self._velocity)
        self._position = self._position + self._velocity * period
        if legs:
            self._position += (1 - math.exp(-period / self._position_time)) * (position - self._position)

    def _anchor(self) -> None:
        """Anchor a foot that has not settled, or carries nothing, where the estimate has it, on the floor.

        After a hasty landing a foot hovers and slides until the weight comes onto it.
        """
        for side, idle in enumerate(self._idle):
            if side == self._settling or idle:
                x, y, _ = self._state.sole(side)[0]
                self._anchors[side] = np.array([x, y, 0.0])


def _within(tilt: float) -> float:
    return min(max(tilt, -_EDGE), _EDGE)


def _finite(joints: JointStates, imu: Imu, wrenches: tuple[FootWrench, FootWrench]) -> bool:
    """Whether everything that the estimate is computed from is finite."""
    readings = (
        joints.position,
        joints.velocity,
        imu.orientation,
        imu.angular_velocity,
        imu.linear_acceleration,
    )
    return all(np.isfinite(array).all() for array in (*readings, *(wrench.force for wrench in wrenches)))
