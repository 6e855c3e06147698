"""A generated package has what setuptools, colcon and ROS's tools expect of an ament_python package."""

from __future__ import annotations

import os
import runpy
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
COLCON = shutil.which("colcon", path=os.pathsep.join((sysconfig.get_path("scripts"), *os.get_exec_path())))
INSTALLED = {
    "share/ament_index/resource_index/packages/robot",
    *(f"share/ament_index/resource_index/nodl/robot__{node}" for node in ("arm", "brain", "gripper")),
    "share/robot/package.xml",
    "share/robot/launch/robot.launch.py",
    "share/robot/config/arm.yaml",
    "share/robot/config/gripper.yaml",
    *(f"share/robot/nodl/{node}.nodl.yaml" for node in ("arm", "brain", "gripper")),
}


def start(script: Path, prefix: Path, *arguments: str) -> str:
    """Run an installed node on the local transport until it reports an error in its parameters."""
    [packages] = prefix.glob("lib/python*/site-packages")
    path = [packages, ROOT / "codegen/underlay", ROOT / "generated", ROOT / "codegen"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))}
    command = [sys.executable, str(script), *arguments]
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=60, check=False
    ).stderr


def test_setuptools_installs_it_as_colcon_does(robot: Path, tmp_path: Path) -> None:
    pytest.importorskip("setuptools")
    source = shutil.copytree(robot / "generated/robot", tmp_path / "source")
    prefix = tmp_path / "prefix"
    install = ["install", "--prefix", prefix, "--single-version-externally-managed", "--record", "record"]
    subprocess.run([sys.executable, "setup.py", "--quiet", *install], cwd=source, timeout=100, check=True)
    assert {name for name in INSTALLED if not (prefix / name).is_file()} == set()
    [packages] = prefix.glob("lib/python*/site-packages")
    assert (packages / "robot/msg/_joint.py").is_file()
    assert (packages / "robot/py.typed").is_file()
    assert not (packages / "test").exists()
    # setup.cfg puts scripts where `ros2 run` looks for them.
    said = start(prefix / "lib/robot/arm", prefix)
    assert said == "arm: parameter 'names' must be given: with -p names:=VALUE or in a file\n"


@pytest.mark.slow
@pytest.mark.skipif(COLCON is None, reason="colcon is not installed")
def test_colcon_builds_it(robot: Path, tmp_path: Path) -> None:
    shutil.copytree(robot / "generated/robot", tmp_path / "src/robot")
    done = subprocess.run(
        [str(COLCON), "build"], cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 0, done.stderr
    prefix = tmp_path / "install/robot"
    assert {name for name in INSTALLED if not (prefix / name).is_file()} == set()
    assert "'names' must be given" in start(prefix / "lib/robot/arm", prefix)


class Anything:
    """Stands in for anything that a launch file makes, and keeps its arguments."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        self.arguments = arguments
        self.keywords = keywords


def test_the_launch_file_starts_every_node(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With stand-ins for `launch` and `launch_ros`, which have no wheels."""
    for name in ("launch", "launch.actions", "launch.substitutions", "launch_ros"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    for name in ("launch_ros.actions", "launch_ros.substitutions"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    kinds = {
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument"],
        "launch.substitutions": ["LaunchConfiguration", "PathJoinSubstitution"],
        "launch_ros.actions": ["LifecycleNode", "Node"],
        "launch_ros.substitutions": ["FindPackageShare"],
    }
    for module, names in kinds.items():
        for name in names:
            monkeypatch.setattr(sys.modules[module], name, type(name, (Anything,), {}), raising=False)
    found = runpy.run_path(str(robot / "generated/robot/launch/robot.launch.py"))
    [actions] = found["generate_launch_description"]().arguments
    started = [(type(a).__name__, a.keywords["executable"]) for a in actions if "executable" in a.keywords]
    assert started == [("Node", "arm"), ("Node", "brain"), ("LifecycleNode", "gripper")]
    arguments = [a.arguments[0] for a in actions if type(a).__name__ == "DeclareLaunchArgument"]
    assert arguments == ["arm_config", "gripper_config"]
