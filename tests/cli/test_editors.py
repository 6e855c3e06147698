"""`ifgen paths` and `ifgen typings`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from ifgen import resources

from .conftest import Run, write


def test_folders_before_there_are_stubs(ifgen: Run, demo_msgs: Path) -> None:
    folders = (resources.underlay(), resources.bundled_generated(), resources.libraries())
    bundled = [folder.as_posix() for folder in folders]
    assert ifgen("paths").out.splitlines() == bundled
    ifgen("generate", demo_msgs)
    assert ifgen("paths").out.splitlines() == ["generated", *bundled]


def test_stubs_are_written_once_and_by_the_same_bytes(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", demo_msgs)
    first = ifgen("typings")
    assert first.code == 0
    assert first.out.startswith("typings: ") and first.out.endswith(" files written, 0 removed\n")
    assert "\nclass Node" in Path("typings/rclpy/node.pyi").read_text()
    assert "class Point(" in Path("typings/geometry_msgs/msg/_point.pyi").read_text()
    assert ifgen("typings").out == "typings: up to date\n"
    assert ifgen("typings", "--check").code == 0
    assert ifgen("paths").out.splitlines() == ["generated", "typings"]


def test_formats(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", demo_msgs)
    write(Path("typings/rclpy/__init__.pyi"), "")
    vscode = json.loads(ifgen("paths", "--format", "vscode").out)
    assert vscode == {
        "python.analysis.extraPaths": ["generated", "typings"],
        "python.analysis.diagnosticSeverityOverrides": {"reportMissingModuleSource": "none"},
    }
    pyright = ifgen("paths", "--format", "pyright").out
    assert tomllib.loads(pyright)["tool"] == {
        "pyright": {"extraPaths": ["generated", "typings"], "reportMissingModuleSource": False}
    }
    assert ifgen("paths", "--format", "mypy").out == (
        '[tool.mypy]\nmypy_path = ["$MYPY_CONFIG_FILE_DIR/generated", "$MYPY_CONFIG_FILE_DIR/typings"]\n'
    )
    assert ifgen("paths", "--format", "pycharm").out.splitlines()[1:] == ["  generated", "  typings"]
    assert json.loads(ifgen("paths", "--json").out) == {
        "paths": [str(Path("generated").resolve()), str(Path("typings").resolve())]
    }


def test_mypy_is_not_told_of_folders_that_it_refuses(
    ifgen: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    installed = tmp_path / "site-packages" / "ifgen_runtime" / "underlay"
    monkeypatch.setattr(resources, "underlay", lambda: installed)
    monkeypatch.setattr(resources, "bundled_generated", lambda: installed)
    monkeypatch.setattr(resources, "libraries", lambda: installed)
    asked = ifgen("paths", "--format", "mypy")
    assert asked.out == "[tool.mypy]\nmypy_path = []\n"
    assert "run `ifgen typings` first" in asked.err


@pytest.mark.slow
def test_drift_edits_and_files_of_others(ifgen: Run) -> None:
    ifgen("typings", "stubs")
    path = Path("stubs/rclpy/qos.pyi")
    text = path.read_text()
    path.write_text(f"{text}# mine\n")
    checked = ifgen("typings", "stubs", "--check")
    assert (checked.code, "-# mine" in checked.out) == (1, True)
    assert checked.err == "stubs is not up to date: run `ifgen typings stubs`\n"
    assert ifgen("typings", "stubs").out == "stubs: 1 file written, 0 removed\n"
    assert path.read_text() == text
    write(Path("other/rclpy/node.pyi"), "x: int\n")
    refused = ifgen("typings", "other")
    assert refused.code == 1
    assert "other/rclpy/node.pyi is in the way: ifgen did not write it" in refused.err
    assert [file.name for file in Path("other").rglob("*") if file.is_file()] == ["node.pyi"]


def test_stubs_are_not_mixed_with_packages(ifgen: Run) -> None:
    refused = ifgen("typings", "generated")
    assert refused.code != 0
    assert "packages are generated into generated" in refused.err
    assert not Path("generated").exists()


@pytest.mark.slow
def test_packages_that_the_project_generates_have_no_stubs(ifgen: Run) -> None:
    ifgen("typings")
    assert Path("typings/std_msgs").is_dir()
    ifgen("generate", resources.bundled_interfaces() / "std_msgs", "--with-deps")
    assert ifgen("typings").out.endswith(" removed\n")
    assert not Path("typings/std_msgs").exists()
    assert Path("typings/geometry_msgs").is_dir()


PROGRAM = """
import rclpy
import tf2_ros
from launch import LaunchDescription
from launch_ros.actions import Node as Started
from rclpy.node import Node
from sensor_msgs_py import point_cloud2
from std_msgs.msg import String

print(Node, String, tf2_ros, LaunchDescription, Started, point_cloud2)
print(rclpy.time.Time(), rclpy.duration.Duration(seconds=0.1), rclpy.qos.qos_profile_sensor_data)
print(rclpy.logging.get_logger("a"), rclpy.executors.SingleThreadedExecutor(), rclpy.clock.Clock())
"""


@pytest.mark.slow
def test_pyright_has_nothing_to_say_of_a_program_that_runs(ifgen: Run) -> None:
    """The stubs and the settings of `ifgen paths`: what `import rclpy` brings along, and no warnings."""
    write(Path("program.py"), PROGRAM)
    write(Path("pyproject.toml"), ifgen("typings").out and ifgen("paths", "--format", "pyright").out)
    command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable, "program.py"]
    checked = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert json.loads(checked.stdout)["generalDiagnostics"] == []


@pytest.mark.slow
def test_tools_that_import_find_everything_by_the_ways_of_the_page(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", demo_msgs)
    ifgen("typings")
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "local", "-m", "pydoc", "demo_msgs.msg"]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert "Help on package demo_msgs.msg" in ran.stdout, ran.stderr
    folders = ifgen("paths", "--typings", "none").out.splitlines()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(folders)}
    command = [sys.executable, "-c", "import demo_msgs.msg, rclpy.node, tf2_ros; print(rclpy.node.__file__)"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert Path(ran.stdout.strip()).parent.parent == resources.underlay(), ran.stderr
