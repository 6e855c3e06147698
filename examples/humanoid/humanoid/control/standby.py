"""Catches the robot when the whole-body controller falls silent: it stands, using only the sensors.

It belongs to the servos, as the protective functions of a drive do, and takes over when no good command has
arrived for a while. It knows nothing about the walk that was under way. It brings both feet to the ground and
stands.
"""

from __future__ import annotations

import numpy as np

from ..data import SECOND, JointCommand, Sensors
from ..kinematics.dynamics import RobotState
from ..robot.model import HumanoidModel
from ..sensing.estimator import StateEstimator
from ..spatial import Array
from .controller import WholeBodyController

PATIENCE = 80_000_000  # ns without a good command: longer than a busy machine keeps a node waiting
_CARRIES = 30.0  # N on a foot that stands
_TRUSTED_AFTER = 1_000_000_000  # ns of good commands without a gap until they control the robot again
_NEAR = 0.15  # rad that their set-points may then differ from those of the standby


class Standby:
    """Takes over when commands stop, until it stands still, and commands last and agree with its set-points.

    It can also be told to, by `hold`.
    """

    def __init__(self, model: HumanoidModel) -> None:
        self._model = model
        self.reset()

    def reset(self) -> None:
        """Let commands control the robot again."""
        self._controller: WholeBodyController | None = None
        self._estimator = StateEstimator(self._model)
        self._last: int | None = None
        self._since: int | None = None  # when the present run of good commands without a gap began
        self._commanded = np.zeros(0)
        self.reason = ""  # why it has taken over
        self._held = ""  # why it is to take over, or to keep on

    def hold(self, why: str) -> None:
        """Take over at the next tick, and keep on until this is called with an empty reason."""
        self._held = why

    def is_due(self, now: int) -> bool:
        """Whether `tick` has anything to do: it has taken over, or should."""
        if self._controller is not None or self._held:
            return True
        return self._last is not None and now - self._last > PATIENCE

    def commanded(self, now: int, setpoints: Array) -> None:
        """Note that a good command (joints,) has arrived."""
        gap = self._last is None or now - self._last > PATIENCE
        self._since = now if gap or self._since is None else self._since
        self._last, self._commanded = now, setpoints

    def tick(self, now: int, sensors: Sensors) -> JointCommand | None:
        """The command to use instead; None while others command, or nobody has begun to."""
        if not self.is_due(now):
            return None
        if self._controller is None:
            silent = 0 if self._last is None else now - self._last
            self.reason = self._held or f"no good command for {silent / SECOND:.2f} s"
            self._begin(sensors)
            assert self._controller is not None
        odometry = self._estimator.update(sensors.joints, sensors.imu, sensors.wrenches, None)
        command = self._controller.tick(now, sensors.joints, sensors.imu, odometry)
        if self._controller.at_rest and self._trusts(now, command):
            self._controller, self.reason = None, ""
            return None
        return command

    def _trusts(self, now: int, command: JointCommand) -> bool:
        """Whether incoming commands may control the robot: they last, and would not move it."""
        if self._held or self._last is None or self._since is None or now - self._last > PATIENCE:
            return False
        lasting = self._last - self._since > _TRUSTED_AFTER
        return lasting and float(np.abs(self._commanded - command.position).max()) < _NEAR

    def _begin(self, sensors: Sensors) -> None:
        """Start from the posture: the lower foot is on the floor; a foot without load is in the air."""
        state = RobotState(self._model)
        state.set_posture(np.zeros(3), sensors.imu.orientation, sensors.joints.position)
        soles = [state.sole(side)[0] for side in (0, 1)]
        floor = np.array([0.0, 0.0, min(sole[2] for sole in soles)])
        carried = [float(wrench.force[2]) for wrench in sensors.wrenches]
        lifted = int(np.argmin(carried)) if min(carried) < _CARRIES else None
        self._estimator.restart([sole - floor for sole in soles], lifted)
        self._controller = WholeBodyController(self._model)
