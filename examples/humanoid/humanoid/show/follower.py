"""A node that follows the robot through what is published; the nodes that show the robot derive from it."""

from __future__ import annotations

import contextlib
from abc import ABC, abstractmethod

import numpy as np
from humanoid_interfaces.msg import FootstepPlan
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from visualization_msgs.msg import MarkerArray

from ..data import Footstep
from ..robot.model import HumanoidModel
from ..robot.obstacles import Solid
from ..ros import messages
from ..ros.markers import read_obstacle_markers
from ..spatial import Array

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Follower(Node, ABC):
    """Combines joint states and ground truth, and keeps the next footsteps and the obstacles."""

    def __init__(self, name: str, model: HumanoidModel) -> None:
        super().__init__(name)
        self._model = model
        self._joints: Array | None = None
        self._steps: tuple[Footstep, ...] = ()
        self.solids: tuple[Solid, ...] = ()
        self.create_subscription(JointState, "/joint_states", self._on_joints, _LATEST)
        self.create_subscription(
            Odometry, "/humanoid_simulator/ground_truth/odom", self._on_odometry, _LATEST
        )
        self.create_subscription(FootstepPlan, "/footsteps/upcoming", self._on_plan, _LATCHED)
        self.create_subscription(MarkerArray, "/humanoid_simulator/obstacles", self._on_obstacles, _LATCHED)

    @abstractmethod
    def wants(self, stamp: int) -> bool:
        """Whether the posture of this moment [ns] is needed; skipped ones cost nothing."""

    @abstractmethod
    def take(self, stamp: int, posture: Array, steps: tuple[Footstep, ...]) -> None:
        """Use a posture, MuJoCo's `qpos` (nq,), and the next footsteps."""

    def _on_joints(self, message: JointState) -> None:
        if len(message.position) == len(self._model.qpos):
            self._joints = np.array(message.position)

    def _on_odometry(self, message: Odometry) -> None:
        stamp = messages.nanoseconds(message.header.stamp)
        if self._joints is None or not self.wants(stamp):
            return
        posture = np.zeros(self._model.mj.nq)
        posture[:3] = messages.numbers(message.pose.pose.position)
        x, y, z, w = messages.numbers(message.pose.pose.orientation)
        posture[3:7] = w, x, y, z
        posture[self._model.qpos] = self._joints
        self.take(stamp, posture, self._steps)

    def _on_plan(self, message: FootstepPlan) -> None:
        with contextlib.suppress(ValueError):  # whoever would walk it says so
            self._steps = messages.read_footstep_plan(message).steps

    def _on_obstacles(self, message: MarkerArray) -> None:
        self.solids = read_obstacle_markers(message)
