"""A colcon workspace as docs/colcon.md describes it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/colcon.md"
COLCON = shutil.which("colcon", path=os.pathsep.join((sysconfig.get_path("scripts"), *os.get_exec_path())))

pytestmark = pytest.mark.skipif(not PAGE.exists(), reason="no checkout")


def run(*words: str | Path, cwd: Path) -> str:
    """The output of a command, which must succeed."""
    done = subprocess.run(
        list(map(str, words)), cwd=cwd, capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The result of the commands on the page, without what colcon builds."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    match = re.search(r"```sh\n(.*?)colcon build\n```", PAGE.read_text(), re.DOTALL)
    assert match is not None
    run("bash", "-euc", match[1], cwd=tmp_path)
    return tmp_path / "ws"


def test_what_lies_where(workspace: Path) -> None:
    there = {path.relative_to(workspace).as_posix() for path in workspace.rglob("*") if path.is_file()}
    assert there >= {
        "pyproject.toml",
        "nodes/COLCON_IGNORE",
        "nodes/robot/package.xml",
        "nodes/robot/nodl/driver.nodl.yaml",
        "src/robot_msgs/CMakeLists.txt",
        "src/robot_msgs/package.xml",
        "src/robot_msgs/msg/Speed.msg",
        "generated/robot/setup.py",
        "generated/robot/package.xml",
        "generated/robot/robot/driver.py",
        "generated/robot_msgs/msg/_speed.py",
    }
    assert not there & {"generated/robot_msgs/package.xml", "generated/robot_msgs/setup.py"}
    assert 'paths = ["src", "nodes"]\noutput = "generated"' in (workspace / "pyproject.toml").read_text()
    assert "1 interface and 1 node in 2 packages: no mistakes" in run("ifgen", "check", cwd=workspace)
    for built in ("build", "install", "log"):
        shutil.copytree(workspace / "src", workspace / built / "share")
    run("ifgen", "generate", "--check", cwd=workspace)


@pytest.mark.slow
def test_colcon_builds_messages_first(workspace: Path) -> None:
    description = workspace / "nodes/robot/nodl/driver.nodl.yaml"
    description.write_text(description.read_text().replace("std_msgs/msg/String", "robot_msgs/msg/Speed"))
    run("ifgen", "generate", cwd=workspace)
    package = ElementTree.parse(workspace / "generated/robot/package.xml").getroot()
    assert "robot_msgs" in {depend.text for depend in package.iter("depend")}


@pytest.mark.slow
@pytest.mark.skipif(COLCON is None, reason="colcon is not installed")
def test_colcon_finds_each_package_once(workspace: Path) -> None:
    assert run(str(COLCON), "list", cwd=workspace).split() == [
        *("robot", "generated/robot", "(ros.ament_python)"),
        *("robot_msgs", "src/robot_msgs", "(ros.ament_cmake)"),
    ]
    (workspace / "nodes/COLCON_IGNORE").unlink()
    found = run(str(COLCON), "list", cwd=workspace).splitlines()
    assert [line.split()[1] for line in found if line.startswith("robot\t")] == [
        "generated/robot",
        "nodes/robot",
    ]
