"""The humanoid's nodes in one process, in lockstep: tests spin them to moments of simulated time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from humanoid.data import SECOND, Mode
from humanoid.ros import messages
from humanoid.show import crew
from humanoid.simulation.sim import Simulator
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import GaitState, TaskStatus
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future

MOTION = (
    "humanoid_simulator",
    "joint_state_publisher",
    "imu_fusion",
    "whole_body_controller",
    "joint_controller",
    "gait_planner",
)
PLANNING = ("motion_planner", "footstep_planner", "footstep_generation_server")
WALKING = (*MOTION, *PLANNING, "navigation_action_server")
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_REAL_TIME = 90.0  # s: the limit of every wait
_SIMULATOR = {"noise": True, "seed": 1, "lockstep": True, "patience": 0.5}


class Robot:
    """Nodes by the names of their modules, and a tester node that knows no more than any other user."""

    def __init__(self, names: Iterable[str], executor: SingleThreadedExecutor, **parameters: Any) -> None:
        self._parameters = parameters | {
            "humanoid_simulator": _SIMULATOR | parameters.get("humanoid_simulator", {})
        }
        self._executor = executor
        self.nodes: dict[str, Node] = {}
        self.tester = Node("tester", parameter_overrides=[Parameter("use_sim_time", value=True)])
        executor.add_node(self.tester)
        self.log: list[tuple[str, str]] = []
        self.gait = GaitState()
        self.listen(Log, "/rosout", lambda line: self.log.append((line.name, line.msg)), 1000)
        self.listen(GaitState, "/gait_state", self._take_gait, LATCHED)
        self.setpoints: list[np.ndarray[Any, Any]] = []  # the set-points of the servos, tick by tick
        self._clients: dict[str, ActionClient] = {}
        for name in names:
            self.start(name)

    @property
    def physics(self) -> Simulator:
        """The true state, which no node may see."""
        physics: Simulator = self.nodes["humanoid_simulator"].simulator  # type: ignore[attr-defined]
        return physics

    @property
    def now(self) -> float:
        """Simulated seconds."""
        return self.physics.stamp / SECOND

    @property
    def mode(self) -> Mode:
        """The mode that the controller reports."""
        return Mode(self.gait.mode)

    @property
    def fell(self) -> bool:
        """Whether the robot has really fallen."""
        return bool(self.physics.data.qpos[2] < 0.45)

    @property
    def standby(self) -> str:
        """The reason why the servos hold the robot on their own, or ""."""
        reason: str = self.nodes["joint_controller"]._standby.reason  # type: ignore[attr-defined]
        return reason

    def start(self, name: str) -> Node:
        """Start a node, for the first time or again."""
        (node,) = crew.make([name], self._parameters)
        self.nodes[name] = node
        if name == "humanoid_simulator":
            self._watch_servos()
        self._executor.add_node(node)
        return node

    def kill(self, name: str) -> None:
        """End a node without notice to anybody."""
        node = self.nodes.pop(name)
        self._executor.remove_node(node)
        node.destroy_node()

    def close(self) -> None:
        """End all."""
        for name in list(self.nodes):
            self.kill(name)
        self._executor.remove_node(self.tester)
        self.tester.destroy_node()

    def listen(
        self, kind: Any, topic: str, heard: Callable[[Any], object], qos: QoSProfile | int = 10
    ) -> None:
        """Subscribe as any user would."""
        self.tester.create_subscription(kind, topic, heard, qos)

    def publisher(self, kind: Any, topic: str, qos: QoSProfile | int = 10) -> Callable[[Any], None]:
        """Publish as any user would."""
        publish: Callable[[Any], None] = self.tester.create_publisher(kind, topic, qos).publish
        return publish

    def run(self, seconds: float) -> None:
        """Let simulated time pass."""
        end = self.physics.stamp + round(seconds * SECOND)
        self.until(lambda: self.physics.stamp >= end)

    def until(self, over: Callable[[], bool]) -> None:
        """Spin until a condition holds; the test fails when that takes too long."""
        limit = time.monotonic() + _REAL_TIME
        while not over():
            assert time.monotonic() < limit, f"still waiting at {self.now:.2f} s: {self.log[-5:]}"
            self._executor.spin_once(timeout_sec=0.1)

    def get(self, future: Future) -> Any:
        """Spin until a future is done; returns its result."""
        self.until(future.done)
        return future.result()

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Ask a service."""
        client = self.tester.create_client(kind, name)
        self.until(client.service_is_ready)
        answer = self.get(client.call_async(request))
        self.tester.destroy_client(client)
        return answer

    def send(self, goal: Any) -> Any:
        """Send a goal; returns its handle, accepted or not."""
        kind, name = (
            (WalkTo, "/walk_to") if isinstance(goal, WalkTo.Goal) else (PerformDance, "/perform_dance")
        )
        client = self._clients.get(name) or ActionClient(self.tester, kind, name)
        self._clients[name] = client
        self.until(client.server_is_ready)
        return self.get(client.send_goal_async(goal))

    def result(self, handle: Any) -> tuple[int, Any]:
        """Wait for the end of a goal; returns status and result."""
        answer = self.get(handle.get_result_async())
        return answer.status, answer.result

    def task(self) -> TaskStatus:
        """What the task manager does."""
        told: list[TaskStatus] = []
        self.listen(TaskStatus, "/high_level_task_manager/task", told.append, LATCHED)
        self.until(lambda: bool(told))
        return told[-1]

    def said(self, node: str, words: str) -> bool:
        """Whether a node has logged a line with these words in it."""
        return any(name == node and words in text for name, text in self.log)

    def expect(self, node: str, words: str) -> None:
        """Wait at most a simulated second for such a line."""
        end = self.now + 1.0
        self.until(lambda: self.said(node, words) or self.now > end)
        assert self.said(node, words), self.log[-8:]

    def height_of_feet(self) -> float:
        """Height of the higher sole above the floor [m]."""
        soles = [self.physics.model.frames[f"{side}_sole"] for side in "lr"]
        return float(self.physics.data.site_xpos[soles, 2].max())

    def _take_gait(self, message: GaitState) -> None:
        self.gait = message

    def _watch_servos(self) -> None:
        physics, step = self.physics, self.physics.step

        def watched() -> None:
            step()
            self.setpoints.append(physics.data.ctrl[physics.model.actuators].copy())

        physics.step = watched  # type: ignore[method-assign]


def walk(x: float, y: float = 0.0, yaw: float = 0.0, frame: str = "odom", **more: Any) -> WalkTo.Goal:
    """A goal for a walk."""
    target = PoseStamped(header=messages.header(0, frame), pose=messages.planar_pose(x, y, yaw))
    return WalkTo.Goal(target=target, **more)
