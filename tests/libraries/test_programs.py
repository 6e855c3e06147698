"""Programs that import libraries, on each transport. The tests in `inside/` run in sessions with a transport."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.real_rclpy import again_if_crashed

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
TIME_LIMIT = 110  # [s] for one of them
needs_rclpy = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None, reason="the ROS wheels are not installed (Linux x86_64 only)"
)
TRANSPORTS = ["local", pytest.param("rclpy", marks=needs_rclpy)]


def run(*words: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **variables}
    for name in [name for name in environment if name.startswith("PYTEST_") or name == "PYTHONPATH"]:
        del environment[name]
    return subprocess.run(
        [sys.executable, "-m", *words],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=TIME_LIMIT,
        check=False,
    )


@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("program", sorted((HERE / "programs").glob("*.py")), ids=lambda path: path.stem)
def test_program(program: Path, transport: str, tmp_path: Path) -> None:
    """It prints what the text beside it says."""
    done = again_if_crashed(
        transport,
        lambda: run("ifgen", "run", "--transport", transport, program, ROS_LOG_DIR=str(tmp_path)),
        lambda done: done.returncode,
    )
    assert (done.stdout, done.returncode) == (program.with_suffix(".txt").read_text(), 0), done.stderr
