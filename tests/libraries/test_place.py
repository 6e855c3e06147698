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


def test_the_one_of_a_ros_wins_where_its_rclpy_does_or_it_is_sourced(
    ros: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package(ros, "ament_index_python")
    assert run(f"import ifgen; ifgen.activate('rclpy'); {SAY}", ros).startswith(str(ros))
    local = f"import ifgen; ifgen.activate('local'); {SAY}"
    assert Path(run(local, ros)).parents[1] == resources.libraries()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(ros.parent))
    assert run(local, ros).startswith(str(ros))
    assert "underlay" in run(
        "import ifgen; ifgen.activate('local'); import rclpy; print(rclpy.__file__)", ros
    )
    other = ros.rename(ros.parent / "python3.4")
    assert Path(run(local, other)).parents[1] == resources.libraries()


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


_THEIR_LAUNCH = {
    "__init__.py": """
class LaunchContext:
    def __init__(self, argv=()): pass
class LaunchDescription:
    def __init__(self, entities): self.entities = entities
class LaunchService:
    def __init__(self, argv=()): self.argv = argv
    def include_launch_description(self, description): self.included = description.entities[0]
    def run(self):
        import os, subprocess
        source, arguments = self.included
        print("theirs", source, arguments)
        index = os.environ["AMENT_PREFIX_PATH"].split(os.pathsep)[0]
        program = f"{index}/lib/user_pkg/hello"
        assert os.path.exists(f"{index}/share/user_pkg/package.xml")
        return subprocess.run([program, "again"]).returncode
""",
    "actions.py": "def IncludeLaunchDescription(source, launch_arguments): return source, launch_arguments",
    "launch_description_sources.py": "def AnyLaunchDescriptionSource(path): return path",
    "launch_service.py": "",
}


def test_the_launch_of_the_user_launches(tmp_path: Path) -> None:
    theirs = package(tmp_path / "theirs", "launch")
    for name, text in _THEIR_LAUNCH.items():
        (theirs / "launch" / name).write_text(text)
    sources = tmp_path / "user_pkg"
    (package(sources, "user_pkg") / "user_pkg/hello.py").write_text(
        "import sys, rclpy\ndef main():\n    print('hello', 'underlay' in rclpy.__file__, sys.argv[1:])\n"
    )
    (sources / "package.xml").write_text("<package><name>user_pkg</name></package>")
    (sources / "setup.py").write_text(
        "setup(entry_points={'console_scripts': ['hello = user_pkg.hello:main']})"
    )
    (sources / "up.launch.py").touch()
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "launch", "--transport", "local", "up.launch.py", "a:=1"],
        cwd=sources,
        env={**os.environ, "PYTHONPATH": os.pathsep.join((str(theirs), str(CODEGEN)))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "theirs up.launch.py [('a', '1')]" in done.stdout
    assert "hello True ['again']" in done.stdout
    assert f"note: the launch in {theirs / 'launch'} does this" in done.stderr
