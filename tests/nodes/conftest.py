"""A workspace with the packages of `packages/`, and the code generated from it."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import ifgen
import pytest

HERE = Path(__file__).parent
CHECKS = """
def odd_count(value):
    if len(value) % 2 == 0:
        raise ValueError(f"there must be an odd number of names, not {len(value)}")


def even(value, divisor):
    if value % divisor:
        raise ValueError(f"must be a multiple of {divisor}")
"""
_MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]
_REASON = f"not installed: {', '.join(_MISSING)} (Linux x86_64 only)"
needs_rclpy = pytest.mark.skipif(bool(_MISSING), reason=_REASON)
TRANSPORTS = ["local", pytest.param("rclpy", marks=needs_rclpy)]
SLOWLY_ON_REAL = ["local", pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow])]

Ifgen = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the generated packages/robot, whose custom validators have their functions."""
    folder = tmp_path_factory.mktemp("robot")
    ifgen.generate(HERE / "packages", output=folder / "generated")
    (folder / "generated/robot/robot/checks.py").write_text(CHECKS)
    return folder


@pytest.fixture(scope="session")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the generated two examples of the format's description, under names that ifgen has too."""
    folder = tmp_path_factory.mktemp("examples")
    for name in ("gait_planner", "whole_body_controller"):
        nodl = folder / "ws" / name / "nodl"
        nodl.mkdir(parents=True)
        for file in {f"{name}.nodl.yaml", "imu_driver_client.nodl.yaml"}:
            if name == "whole_body_controller" or file.startswith(name):
                shutil.copy(HERE.parent / "nodl/examples" / file, nodl)
    ifgen.generate(folder / "ws", output=folder / "generated")
    return folder


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Only the sources, in a working directory with a cache of its own."""
    shutil.copytree(HERE / "packages", tmp_path / "ws")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


@pytest.fixture
def run_ifgen() -> Ifgen:
    """`ifgen ARGUMENTS...` in a process, with a limit."""

    def run(*arguments: str | Path, folder: Path, limit: float = 100.0) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "ifgen", *map(str, arguments)]
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=limit, check=False)

    return run
