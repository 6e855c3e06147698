"""Faults in the running graph of nodes: each file of `graph/` in a process whose rclpy is ours.

Our rclpy and the real one can never share a process, and this one may have the real one.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
MODE_STANDING, MODE_STOPPING = 1, 3
REAL = all(importlib.util.find_spec(name) for name in ("rpyutils", "ifgen_native"))
KILL = """
import runpy, ifgen
ifgen.activate("rclpy")
runpy.run_path("tests/humanoid/graph/killing.py", run_name="__main__")
"""
FILES = sorted((HERE / "graph").glob("test_*.py"))
FAST = {"test_garbage"}


def run_inside(file: Path, folder: Path, *, slow: bool, limit: float) -> None:
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST_", "ROS_"))}
    environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "OFF"
    environment |= {
        "IFGEN_INSIDE_GRAPH": "1",
        "ROS_LOG_DIR": str(folder),  # not among the user's
    }
    which = "slow" if slow else "not slow"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--transport", "local"]
    command += [f"--timeout={limit:g}", "-m", which, str(file)]
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=limit, check=False
    )
    nothing_to_do = 5
    assert done.returncode in (0, nothing_to_do if slow else 0), (
        f"{done.stdout[-8000:]}\n{done.stderr[-4000:]}"
    )


@pytest.mark.timeout(220)
@pytest.mark.parametrize(
    "file",
    [pytest.param(path, marks=[] if path.stem in FAST else pytest.mark.slow) for path in FILES],
    ids=[path.stem for path in FILES],
)
def test_faults(file: Path, tmp_path: Path) -> None:
    """Every test in the file passes."""
    run_inside(file, tmp_path, slow=False, limit=200)


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_more_faults(file: Path, tmp_path: Path) -> None:
    """Every slow test in the file passes."""
    run_inside(file, tmp_path, slow=True, limit=800)


@pytest.mark.alone
@pytest.mark.timeout(400)
@pytest.mark.skipif(not REAL, reason="real rclpy, or ifgen's type support for it, is not installed")
@pytest.mark.parametrize(
    ("node", "words"),
    [
        ("gait_planner", "whole_body_controller: holding: gait_planner has been silent for 0.10 s"),
        ("imu_fusion", "whole_body_controller: holding: no odometry from imu_fusion for 0."),
        (
            "whole_body_controller",
            "joint_controller: the servos hold the robot on their own: no good command for 0.0",
        ),
        (
            "navigation_action_server",
            "gait_planner: navigation_action_server, or whoever sent the plan under way",
        ),
    ],
)
def test_a_process_is_killed_on_real_rclpy(node: str, words: str) -> None:
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT / "examples/humanoid"),
    }
    done = subprocess.run(
        [sys.executable, "-c", KILL, node],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=380,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    assert not seen["fell"]
    assert any(line.startswith(words) for line in seen["log"]), seen["log"]
    if node == "navigation_action_server":  # the balance is fine: the walk ends normally
        assert seen["mode"] in {MODE_STANDING, MODE_STOPPING}
    else:
        assert seen["down_after"] <= 2.0  # a fast walk takes one more step
