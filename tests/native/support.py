"""Helpers of the tests of real rclpy: whether it is installed, running programs, our message classes."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GENERATED = ROOT / "generated"
PROGRAMS = Path(__file__).parent / "programs"


def has_wheels_of(name: str) -> bool:
    """Whether the wheels of a distribution of ROS 2 are installed."""
    try:
        return bool(version(f"ros-{name}-rclpy"))
    except PackageNotFoundError:
        return False


MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]

DISTRIBUTION = next((name for name in ("jazzy", "kilted") if has_wheels_of(name)), None)
"""The ROS 2 whose wheels are here."""

needs_rclpy = pytest.mark.skipif(
    bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (Linux x86_64 only)"
)


def run_python(
    *arguments: str, environment: dict[str, str] | None = None, limit: float = 60.0
) -> subprocess.CompletedProcess[str]:
    """Run this interpreter in a process of its own, with a time limit; `environment` extends this one's."""
    command = [sys.executable, *arguments]
    return subprocess.run(
        command,
        env={**os.environ, **(environment or {})},
        capture_output=True,
        text=True,
        timeout=limit,
        check=False,
    )


def never_compiled(folder: Path, packages: Iterable[str]) -> Path:
    """A folder with our packages of these names, to put before compiled ones on the path."""
    folder.mkdir()
    for name in packages:
        (folder / name).symlink_to(GENERATED / name)
    return folder
