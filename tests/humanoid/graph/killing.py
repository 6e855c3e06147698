"""On real rclpy: kills the process of one node while the robot walks, and prints the outcome as JSON.

The argument is the node; each node that may die has a process of its own.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from humanoid.data import SECOND
from humanoid.ros import messages
from humanoid_interfaces.action import WalkTo
from humanoid_interfaces.msg import GaitState, Stance
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

PROCESSES = (
    ("humanoid_simulator",),
    ("joint_state_publisher",),
    ("imu_fusion",),
    ("whole_body_controller",),
    ("joint_controller",),
    ("gait_planner",),
    ("motion_planner",),
    ("footstep_planner",),
    ("footstep_generation_server",),
    ("navigation_action_server",),
)
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SIMULATOR = {"ground_truth": True, "patience": 2.0, "seed": 1}
LIMIT = 240.0  # s of real time
WATCHED = 3.0  # s of simulated time after the kill


class Witness(Node):
    """Records what really happens, and what is logged."""

    def __init__(self) -> None:
        super().__init__("witness")
        self.now, self.height = 0.0, 1.0
        self.support, self.off_ground = Stance.SUPPORT_BOTH, 0.0
        self.gait = GaitState()
        self.log: list[str] = []
        truth = "/humanoid_simulator/ground_truth"
        self.create_subscription(Odometry, f"{truth}/odom", self._on_odometry, NEWEST)
        self.create_subscription(Stance, f"{truth}/stance", self._on_stance, NEWEST)
        self.create_subscription(GaitState, "/gait_state", self._on_gait, LATCHED)
        self.create_subscription(Log, "/rosout", self._on_log, 1000)

    def _on_odometry(self, message: Odometry) -> None:
        self.now = messages.nanoseconds(message.header.stamp) / SECOND
        self.height = message.pose.pose.position.z

    def _on_stance(self, message: Stance) -> None:
        if message.support != Stance.SUPPORT_BOTH:
            self.off_ground = messages.nanoseconds(message.header.stamp) / SECOND

    def _on_gait(self, message: GaitState) -> None:
        self.gait = message

    def _on_log(self, message: Log) -> None:
        self.log.append(f"{message.name}: {message.msg}")


def main(victim: str) -> None:
    document = json.dumps({"humanoid_simulator": SIMULATOR})
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    processes = {
        names[0]: subprocess.Popen(
            [sys.executable, "-m", "humanoid.show.crew", document, "{}", "tasks", *names],
            env=environment,
            stdin=subprocess.PIPE,
        )
        for names in PROCESSES
    }
    rclpy.init(args=[])
    witness = Witness()
    try:
        print(json.dumps(scene(witness, victim, processes)), flush=True)
    finally:
        for process in processes.values():
            process.kill()
            process.wait()
    # Shutting rclpy down just after other processes were killed sometimes ends in a segmentation fault.
    os._exit(0)


def scene(witness: Witness, victim: str, processes: dict[str, subprocess.Popen[bytes]]) -> dict[str, Any]:
    client = ActionClient(witness, WalkTo, "/walk_to")
    until(witness, "to stand", lambda: witness.gait.mode == GaitState.MODE_STANDING)
    until(witness, "the action server", client.server_is_ready)
    goal = WalkTo.Goal(target=messages.stamped(0, messages.planar_pose(2.0, 0.3, 0.5)))
    accepted = False
    while not accepted:  # rejected until navigation has discovered the services that it needs
        sending = client.send_goal_async(goal)
        until(witness, "an answer to the goal", sending.done)
        handle = sending.result()
        accepted = handle is not None and handle.accepted
    until(
        witness,
        "the third step",
        lambda: witness.gait.footstep_index >= 2 and 0.4 < witness.gait.phase < 0.7,
    )
    killed = witness.now
    processes[victim].send_signal(signal.SIGKILL)
    until(witness, "the end", lambda: witness.now > killed + WATCHED or witness.height < 0.45)
    return {
        "down_after": witness.off_ground - killed,
        "fell": witness.height < 0.45,
        "mode": witness.gait.mode,
        "reason": witness.gait.reason,
        "log": witness.log[-20:],
    }


def until(witness: Witness, what: str, over: Callable[[], bool]) -> None:
    limit = time.monotonic() + LIMIT
    while not over():
        if time.monotonic() > limit:
            raise SystemExit(f"still waiting for {what} at {witness.now:.2f} s: {witness.log[-9:]}")
        rclpy.spin_once(witness, timeout_sec=0.1)


if __name__ == "__main__":
    main(sys.argv[1])
