"""Runs tests that need our rclpy in their own process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
TIME_LIMIT = 110  # [s] for one of them


def has_slow_tests(part: Path) -> bool:
    """Whether some of the tests in a file or a folder are marked as slow."""
    files = [part] if part.is_file() else part.rglob("test_*.py")
    return any("mark.slow" in file.read_text(encoding="utf-8") for file in files)


def run(part: Path, logs: Path, *, slow: bool = False, **variables: str) -> None:
    """Run the tests in a file or a folder, the slow ones or the others, and fail with their output if one fails."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, UNDERLAY)),
        "IFGEN_INSIDE_UNDERLAY": "1",
    }
    for name in [name for name in environment if name.startswith(("PYTEST_", "ROS_", "RCUTILS_"))]:
        del environment[name]
    environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "OFF"
    environment["ROS_LOG_DIR"] = str(logs)  # not among the user's
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--timeout=100"]
    command += ["-m", "slow" if slow else "not slow", str(part)]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=environment | variables,
        capture_output=True,
        text=True,
        timeout=TIME_LIMIT,
        check=False,
    )
    assert done.returncode == 0, f"{done.stdout[-8000:]}\n{done.stderr[-4000:]}"
