"""Advice about modules that a program imports in vain."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen import resources
from ifgen_tools.running.ending import tell


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("nav_msg.msg", "help: did you mean 'nav_msgs'?"),
        ("sensor_mgs", "help: did you mean 'sensor_msgs'?"),
        ("tf2_roos", "help: did you mean 'tf2_ros'?"),
        ("rclpyy", "help: did you mean 'rclpy'?"),
        ("my_robt_msgs.msg", "help: did you mean 'my_robot_msgs'?"),
        ("cv_bridge", "help: 'cv_bridge' comes with a ROS only: source one."),
        ("moveit_msgs.msg", "help: put the interfaces of 'moveit_msgs' among those of your project"),
        ("numpyy", ""),
    ],
)
def test_advice(
    name: str,
    advice: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "my_robot_msgs").mkdir()
    (tmp_path / "my_robot_msgs/.ifgen-manifest.json").touch()
    monkeypatch.syspath_prepend(str(resources.bundled_generated()))
    monkeypatch.syspath_prepend(str(tmp_path))
    tell(ModuleNotFoundError(f"No module named {name!r}", name=name))
    said = capsys.readouterr().err.splitlines()
    assert said[0] == f"ModuleNotFoundError: No module named {name!r}"
    assert said[1:] == [] if not advice else said[1].startswith(advice)


@pytest.mark.parametrize(
    ("line", "near"),
    [
        ("import nav_msgs.mgs", "nav_msgs.msg"),
        ("from nav_msgs.mgs import Odometry", "nav_msgs.msg"),
        ("from nav_msgs import mgs", "nav_msgs.msg"),
        ("from rclpy.exectuors import Executor", "rclpy.executors"),
        ("from std_msgs.msg import Strng", "String"),
        ("from sensor_msgs.msg import Lasercan", "LaserScan"),
        ("from nav_msgs.msg import Spectrometer", ""),
        ("import nav_msgs.spectrometer", ""),
    ],
)
def test_near_names_within_a_package(line: str, near: str, capsys: pytest.CaptureFixture[str]) -> None:
    """They are said once: since 3.12, Python itself suggests names that a module has."""
    with pytest.raises(ImportError) as raised:
        exec(line, {})
    tell(raised.value)
    said = capsys.readouterr().err
    last = said[said.index("Error: ") :]
    assert last.lower().count("did you mean") == (near != "")
    assert near in last
