"""Which transport the tools look at, and what they say where the other one was meant."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]


def tool(*words: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", **variables}
    command = [sys.executable, "-m", "ifgen", *words]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=100, check=False
    )


def test_a_variable_is_the_default(tmp_path: Path) -> None:
    ran = tool("topic", "list", folder=tmp_path, IFGEN_TRANSPORT="zenoh")
    assert ran.returncode == 2
    assert "invalid value for '--transport': 'zenoh' is not one of 'local', 'rclpy', 'auto'" in ran.stderr


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")
def test_who_finds_nothing_on_the_real_rclpy_is_told_of_the_other_one(tmp_path: Path) -> None:
    environment = {name: text for name, text in os.environ.items() if name != "IFGEN_TRANSPORT"}
    chosen = tool("topic", "type", "/imu", "--transport", "rclpy", folder=tmp_path)
    assert "--transport local" not in chosen.stderr
    ran = tool("topic", "type", "/imu", folder=tmp_path, **environment)
    assert ran.returncode == 1
    assert "add --transport local, or set IFGEN_TRANSPORT=local" in ran.stderr
