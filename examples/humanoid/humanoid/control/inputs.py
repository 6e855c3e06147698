"""The inputs of a controller: bad readings are refused and counted, and missing ones are noticed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..data import SECOND, FootWrench, GaitState, Imu, JointStates, Odometry, Support
from ..kinematics.dynamics import RobotState
from ..robot.model import GRAVITY, HumanoidModel
from ..sensing.estimator import StateEstimator
from ..spatial import matrix_of
from .plausible import NOT_FINITE, imu_problem, joints_problem, odometry_problem

LATE = 50_000_000  # ns: an older reading counts as missing unless the caller sets another age
LEASE = 100_000_000  # ns that a sign of life is valid: at 50 Hz four may get lost
_LEFT_SHARE = {Support.LEFT: 1.0, Support.RIGHT: 0.0}  # of the weight on the left foot
_JUMP = 0.05  # m between two consecutive positions of the base


@dataclass(slots=True)
class InputRefusals:
    """The number of refused readings, by reason, and of ticks in which a reading was missing."""

    not_finite: int = 0
    implausible: int = 0
    late: int = 0

    @property
    def total(self) -> int:
        """All refused readings; ticks without a reading are not counted."""
        return self.not_finite + self.implausible


class Leases:
    """The nodes that must keep reporting while the robot walks. A node that never reported is not awaited."""

    def __init__(self) -> None:
        self._heard: dict[str, tuple[int, int]] = {}  # when it was heard, and for how long that is valid

    def heard(self, node: str, now: int, lease: int) -> None:
        """Note a sign of life of a node, valid for the lease [ns]."""
        self._heard[node] = (now, lease)

    def problem(self, now: int) -> str:
        """The node that has fallen silent, in words, or ""."""
        for node, (last, lease) in self._heard.items():
            if now - last > lease:
                return f"{node} has been silent for {(now - last) / SECOND:.2f} s"
        return ""


class Inputs:
    """The newest good readings of a controller, with odometry of its own if that is missing."""

    def __init__(self, model: HumanoidModel, late: int = LATE) -> None:
        """Listen; a reading older than `late` [ns] counts as missing."""
        self._late = late
        self.refusals = InputRefusals()
        self.problem = ""  # which reading has stopped coming, in words
        self._model = model
        self._joints: JointStates | None = None
        self._imu: Imu | None = None
        self._odometry: Odometry | None = None
        self._own: StateEstimator | None = None
        self._position: np.ndarray | None = None  # of the base, as last used

    def take(
        self, now: int, joints: JointStates, imu: Imu, odometry: Odometry | None, gait: GaitState
    ) -> tuple[JointStates, Imu, Odometry] | None:
        """The readings to use at a moment; None if none of them tells the robot's posture."""
        self.problem = ""
        if self._takes(joints_problem(joints, self._model)):
            self._joints = joints
        if self._takes(imu_problem(imu)):
            self._imu = imu
        if (
            odometry is not None
            and now - odometry.stamp <= self._late
            and self._takes(self.odometry_problem(odometry))
        ):
            self._odometry = odometry
        if self._joints is None or self._imu is None or self._odometry is None:
            return None  # not begun yet
        for name, reading in (("joint states", self._joints), ("IMU readings", self._imu)):
            if now - reading.stamp > self._late:
                self._missing(name, now - reading.stamp)
                return None
        if now - self._odometry.stamp > self._late:
            self._missing("odometry from imu_fusion", now - self._odometry.stamp)
            odometry = self._estimate(self._joints, self._imu, gait)
        else:
            self._own, odometry = None, self._odometry
        self._position = odometry.position
        return self._joints, self._imu, odometry

    def _estimate(self, joints: JointStates, imu: Imu, gait: GaitState) -> Odometry:
        """Odometry from the controller's own legs, starting at the last known positions of the soles."""
        if self._own is None:
            self._own = StateEstimator(self._model)
            last = self._odometry
            assert last is not None
            state = RobotState(self._model)
            moved = matrix_of(last.orientation) @ last.linear_velocity * (self._late / SECOND)
            position = last.position + moved
            state.set_posture(position, imu.orientation, joints.position)
            self._own.restart([state.sole(side)[0] for side in (0, 1)])
        # The controller hears no wrenches: the feet that stand by its plan carry the robot.
        share = _LEFT_SHARE.get(gait.stance.support, 0.5)
        weight = np.array([0.0, 0.0, self._model.mass * GRAVITY])
        left, right = (FootWrench(joints.stamp, part * weight, np.zeros(3)) for part in (share, 1 - share))
        return self._own.update(joints, imu, (left, right), gait)

    def odometry_problem(self, odometry: Odometry) -> str:
        """The reason to refuse odometry, or ""; it must continue from where it was."""
        problem, last = odometry_problem(odometry), self._position
        if not problem and last is not None:
            moved = float(np.abs(odometry.position - last).max())
            problem = f"/odom jumps by {moved:.2f} m" if moved > _JUMP else ""
        return problem

    def _takes(self, problem: str) -> bool:
        if problem:
            if problem.endswith(NOT_FINITE):
                self.refusals.not_finite += 1
            else:
                self.refusals.implausible += 1
        return not problem

    def _missing(self, name: str, age: int) -> None:
        self.refusals.late += 1
        self.problem = f"no {name} for {age / SECOND:.2f} s"
