"""The programs that launch files of robots start: their frames, as listeners on each transport see them."""

from __future__ import annotations

import math
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from ifgen import resources

from .test_programs import HERE, needs_rclpy, run

sys.path.append(str(resources.libraries()))


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow])])
def test_frames_of_a_robot(transport: str, tmp_path: Path) -> None:
    file = HERE / "robot/robot.launch.py"
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "launch", "--transport", transport, file],
        cwd=tmp_path,  # the humanoid of this project has a joint_state_publisher of its own
        env={**os.environ, "ROS_LOG_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    lines = [
        line.removeprefix("[check.py-4] ") for line in done.stdout.splitlines() if "check.py-4] " in line
    ]
    # The shoulder is at 0.4, the middle of its limits; `right` follows it: 0.1 - 0.5 * 0.4.
    half, yaw = 0.2, math.pi / 4
    pitch = (-math.sin(yaw) * math.sin(half), math.cos(yaw) * math.sin(half))
    x, y = pitch
    z, w = math.sin(yaw) * math.cos(half), math.cos(yaw) * math.cos(half)
    s, c = math.sin(-0.05), math.cos(-0.05)
    turned = (x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s)
    expected = " ".join(f"{value:.4f}" for value in (-1.5, 0.1, 0.5, *turned))
    topics = [
        "base /tf_static",
        "finger /tf",
        "other_finger /tf",
        "slide /tf",
        "tower /tf_static",
        "upper /tf",
    ]
    own = [line for line in lines if not line.startswith("[") and "process" not in line]
    assert own == [*topics, expected, 'name="arm">'], done.stdout


LINK = "<link name='a'/><link name='b'/>"


def joint(inside: str, kind: str = "fixed", name: str = "j") -> str:
    return f"<joint name='{name}' type='{kind}'>{inside}</joint>"


FLAT, NO_AXIS, MIMIC = "<origin xyz='1 2'/>", "<axis xyz='0 0 0'/>", "<mimic joint='x'/>"
AB = "<parent link='a'/><child link='b'/>"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the robot description is empty"),
        ("<robot", "the robot description is not XML: unclosed token: line 1, column 0"),
        ("<model/>", "the outermost element of a robot description must be 'robot', got 'model'"),
        ("<robot/>", "the robot has no link"),
        (f"<robot>{LINK}</robot>", "with one root; there are 'a', 'b'"),
        (f"<robot>{LINK}{LINK}</robot>", "the robot has two links '"),
        (f"<robot>{LINK}{joint('')}</robot>", "the joint 'j' needs a 'parent'"),
        (f"<robot>{LINK}{joint(AB, 'ball')}</robot>", "the joint 'j' has the type 'ball', expected one of revolute"),
        (f"<robot>{LINK}{joint(AB, 'revolute')}</robot>", "the joint 'j' of type revolute needs a 'limit'"),
        (f"<robot>{LINK}{joint(AB)}{joint(AB)}</robot>", "the robot has two joints 'j'"),
        (f"<robot>{LINK}{joint(AB)}{joint(AB, name='k')}</robot>", "the link 'b' is the child of two joints"),
        (f"<robot>{LINK}{joint(AB.replace('b', 'c'))}</robot>", "names the link 'c', which is not there"),
        (f"<robot>{LINK}{joint(AB + FLAT)}</robot>", "'xyz' of the joint 'j' must be three numbers"),
        (f"<robot>{LINK}{joint(AB + NO_AXIS, 'continuous')}</robot>", "has an axis of length 0"),
        (f"<robot>{LINK}{joint(AB + MIMIC)}</robot>", "follows 'x', which is no joint"),
    ],
)  # fmt: skip
def test_wrong_robots(text: str, message: str) -> None:
    urdf: Any = import_module("robot_state_publisher.urdf")
    with pytest.raises(urdf.UrdfError, match=re.escape(message)):
        urdf.read_urdf(text)


def test_a_wrong_robot_ends_the_program_with_one_line(tmp_path: Path) -> None:
    (tmp_path / "wrong.urdf").write_text("<model/>")
    words = ("robot_state_publisher", "robot_state_publisher", str(tmp_path / "wrong.urdf"))
    done = run("ifgen", "run", "--transport", "local", *words)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert (
        "robot_state_publisher: the outermost element of a robot description must be 'robot'" in done.stderr
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("0", "0", "0", "0", "0", "0", "a", "a"), "cannot publish static transform from 'a' to 'a'"),
        (("--frame-id", "a"), "the following arguments are required: --child-frame-id"),
        (("--frame-id", "a", "--child-frame-id", "b", "--qw", "1", "--yaw", "1"), "give either --roll"),
        (("--frame-id", "a", "--child-frame-id", "b", "--qw", "0"), "the quaternion is 0"),
    ],
)
@pytest.mark.slow
def test_wrong_transforms(words: tuple[str, ...], message: str) -> None:
    done: subprocess.CompletedProcess[str] = run(
        "ifgen", "run", "--transport", "local", "tf2_ros", "static_transform_publisher", *words
    )
    assert done.returncode == 2
    assert message in done.stderr
