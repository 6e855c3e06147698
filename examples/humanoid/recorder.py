"""Keeps what the robot did, from messages, and makes pictures of it when it is over."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from humanoid_interfaces.msg import FootstepPlan
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from . import messages
from .data import Footstep
from .model import HumanoidModel
from .rendering import FRAME_TIME, FollowCamera, save_gif, save_png
from .sim import Simulator
from .spatial import Array

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_SPEED = 2  # of the animation: each picture stands for twice its time
_PERIOD = FRAME_TIME * 1_000_000 * _SPEED  # ns of simulated time between pictures


class Recorder(Node):
    """Remembers postures and footsteps; drawing waits until time no longer matters."""

    def __init__(self, model: HumanoidModel) -> None:
        super().__init__("recorder")
        self._model = model
        self._shots: list[tuple[Array, tuple[Footstep, ...]]] = []
        self._joints: Array | None = None
        self._steps: tuple[Footstep, ...] = ()
        self._due = 0
        self.create_subscription(JointState, "/joint_states", self._on_joints, _LATEST)
        self.create_subscription(
            Odometry, "/humanoid_simulator/ground_truth/odom", self._on_odometry, _LATEST
        )
        self.create_subscription(FootstepPlan, "/footsteps/upcoming", self._on_plan, _LATCHED)

    def save(self, path: Path) -> None:
        """Write an animation (.gif), or a picture of the last moment (.png). Raises RenderingError."""
        camera = FollowCamera(self._model)
        stage = Simulator(self._model)
        try:
            if path.suffix.lower() == ".png":
                save_png(self._draw(camera, stage, *self._shots[-1]), path)
            else:
                save_gif([self._draw(camera, stage, *shot) for shot in self._shots], path)
        finally:
            camera.close()

    def _draw(
        self, camera: FollowCamera, stage: Simulator, posture: Array, steps: tuple[Footstep, ...]
    ) -> np.ndarray:
        stage.data.qpos[:] = posture
        mujoco.mj_forward(self._model.mj, stage.data)
        return camera.picture(stage, steps)

    def _on_joints(self, message: JointState) -> None:
        self._joints = np.array(message.position)

    def _on_odometry(self, message: Odometry) -> None:
        stamp = messages.nanoseconds(message.header.stamp)
        if stamp < self._due or self._joints is None:
            return
        self._due = stamp + _PERIOD
        posture = np.zeros(self._model.mj.nq)
        posture[:3] = messages.numbers(message.pose.pose.position)
        x, y, z, w = messages.numbers(message.pose.pose.orientation)
        posture[3:7] = w, x, y, z
        posture[self._model.qpos] = self._joints
        self._shots.append((posture, self._steps))

    def _on_plan(self, message: FootstepPlan) -> None:
        self._steps = messages.read_footstep_plan(message).steps
