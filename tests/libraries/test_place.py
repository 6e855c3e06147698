"""Whose library a program imports: each package for itself, unlike rclpy and messages."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen import resources

CODEGEN = Path(__file__).resolve().parents[2] / "codegen"
SAY = "import ament_index_python as found; print(found.__file__)"


def package(folder: Path, name: str) -> Path:
    (folder / name).mkdir(parents=True)
    (folder / name / "__init__.py").touch()
    return folder


def run(program: str, *path: Path) -> str:
    """Run a program on a Python without site-packages, so that a ROS is there only if the test adds one."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (*path, CODEGEN)))}
    command = [sys.executable, "-S", "-c", program]
    done = subprocess.run(
        command,
        cwd=Path.cwd().root,  # no project
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.fixture
def ros(tmp_path: Path) -> Path:
    """A folder with an rclpy and messages that are not ours."""
    package(tmp_path / "ros", "std_msgs")
    return package(tmp_path / "ros", "rclpy")


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_ours_fill_the_gap(transport: str, ros: Path) -> None:
    said = run(f"import ifgen; ifgen.activate({transport!r}); ifgen.activate({transport!r}); {SAY}", ros)
    assert Path(said).parents[1] == resources.libraries()


def test_the_one_of_a_ros_wins_where_its_rclpy_does(ros: Path) -> None:
    package(ros, "ament_index_python")
    assert run(f"import ifgen; ifgen.activate('rclpy'); {SAY}", ros).startswith(str(ros))
    assert Path(run(f"import ifgen; ifgen.activate('local'); {SAY}", ros)).parents[1] == resources.libraries()


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_the_users_own_wins(transport: str, ros: Path, tmp_path: Path) -> None:
    own = package(tmp_path / "own", "ament_index_python")
    assert run(f"import ifgen; ifgen.activate({transport!r}); {SAY}", ros, own).startswith(str(own))


def test_packages_of_nodes_that_pip_installed_find_them(ros: Path) -> None:
    program = f"from ifgen_runtime.importing import ensure_importable as e; e('std_msgs', 'rclpy'); {SAY}"
    assert Path(run(program)).parents[1] == resources.libraries()
    assert Path(run(program, ros)).parents[1] == resources.libraries()
    package(ros, "ament_index_python")
    assert run(program, ros).startswith(str(ros))


def test_packages_of_messages_that_pip_installed_leave_sys_path_alone(ros: Path) -> None:
    program = "import sys; from ifgen_runtime.importing import ensure_importable as e; e('std_msgs'); print(sys.path)"
    assert "libraries" not in run(program, ros)


def test_tf2_stands_on_what_upstreams_tf2_py_has() -> None:
    """A ROS may have only some of the packages: tf2_py has no submodules there, and its BufferCore refuses None."""
    program = """
import sys, types, ifgen
ifgen.activate("local")
import tf2_py as ours

class BufferCore(ours.BufferCore):
    def __init__(self, *cache_time):
        assert None not in cache_time
        super().__init__(*cache_time)

upstreams = types.ModuleType("tf2_py")
vars(upstreams).update({name: getattr(ours, name) for name in ours.__all__}, BufferCore=BufferCore)
for name in [name for name in sys.modules if name.startswith("tf2_py")]:
    del sys.modules[name]
sys.modules["tf2_py"] = upstreams
import tf2_ros, tf2_geometry_msgs
assert isinstance(tf2_ros.Buffer(), BufferCore)
print(tf2_ros.Buffer(tf2_ros.Duration(seconds=1)).all_frames_as_yaml())
"""
    assert run(program) == "[]"
