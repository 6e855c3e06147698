"""Replay a recording of the humanoid's graph through single nodes, in virtual time.

python benchmarks/replay.py [--seconds 600] [--bag FILE]     FILE is recorded if it is not there

All nodes of `ifgen demo` walk to and fro on the local transport while everything that they publish is
recorded, with simulated times. Then the recording goes through one node after the other, as in a test with
the fixture `replay`. CPU is that of one thread, which also reads the bag and keeps what the node publishes.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "examples/humanoid"))

import ifgen

ifgen.activate("local")

# ruff: noqa: E402  # importable only from here on
from battery_monitor.battery_monitor import BatteryMonitor
from gait_planner.gait_planner import GaitPlanner
from humanoid.trials import graph_trials as trials
from humanoid.trials.graph import NodeGraph
from humanoid.trials.user import User
from ifgen_pytest.recording import publications
from ifgen_pytest.replaying import replay
from ifgen_runtime.bag import Bag, Recorder
from imu_fusion.imu_fusion import ImuFusion
from rclpy.node import Node
from sensor_msgs.msg import Imu, JointState

GOALS = ((1.0, 0.5, 1.57), (0.0, 0.0, 0.0))
ASKED = 20  # times real time


class Listener(Node):
    """Counts the readings of two sensors."""

    def __init__(self) -> None:
        super().__init__("listener")
        self.count = 0
        self.create_subscription(Imu, "/imu/data", self.on_reading, 10)
        self.create_subscription(JointState, "/joint_states", self.on_reading, 10)

    def on_reading(self, _: Imu | JointState) -> None:
        """Count it."""
        self.count += 1


def main() -> None:
    """Record if need be, replay and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--bag", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = options.bag or Path(folder) / "graph.mcap"
        if not path.exists():
            record(path, options.seconds)
        with Bag(path) as bag:
            seconds = ((bag.end or 0) - (bag.start or 0)) / 1e9
            print(f"{seconds:.0f} s, {len(bag):,} messages of {len(bag.topics)} topics\n")
        print("| node | messages published | CPU [s] | times real time | asked |\n|---|---:|---:|---:|---:|")
        for node in (Listener, BatteryMonitor, GaitPlanner, ImuFusion):
            published, cpu = replayed(path, node)
            print(
                f"| {node.__name__} | {published:,} | {cpu:.1f} | {seconds / cpu:.0f} | {ASKED} |", flush=True
            )


def record(path: Path, seconds: float) -> None:
    """Let the robot walk for some simulated seconds."""
    now = 0

    def heard(topic: str, publisher: Any, message: Any, _: int) -> None:
        nonlocal now
        recorder.write(topic, message, now)
        if topic == "/clock":
            now = message.clock.sec * 10**9 + message.clock.nanosec

    async def wander(user: User) -> None:
        begun, walks = user.now, 0
        while user.now - begun < seconds:
            await trials.walk_to(user, GOALS[walks % 2], 0.0, 0)
            walks += 1

    with Recorder(path) as recorder, publications(heard), NodeGraph(seed=1) as graph:
        graph.play(wander)


def replayed(path: Path, node: Callable[[], Node]) -> tuple[int, float]:
    """How many messages a node publishes in a replay, and the CPU time that it takes [s]."""
    before = time.process_time()
    outputs = replay(path, node).outputs
    return len(outputs), time.process_time() - before


if __name__ == "__main__":
    main()
