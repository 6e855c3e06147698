"""Each verb that finds nobody on the local transport says who is on the real rclpy."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from ifgen.cli.main import commands
from ifgen_runtime.bag import Recorder
from ifgen_runtime.domains import neighbours
from ifgen_runtime.domains.neighbours import Nodes
from ifgen_tools import lookout
from std_msgs.msg import String

from tests.cli.conftest import Run

SENTENCE = "at least 5 nodes run on the real rclpy: --transport rclpy"

GET = "rcl_interfaces/srv/GetParameters"
VERBS = {
    "action find": "example_interfaces/action/Fibonacci",
    "action info": "/walk",
    "action list": "",
    "action send_goal": "/walk example_interfaces/action/Fibonacci",
    "action type": "/walk",
    "bag play": "bag",
    "bag record": "-a",
    "lifecycle get": "",
    "lifecycle get /camera": "/camera",
    "lifecycle list": "/camera",
    "lifecycle nodes": "",
    "lifecycle set": "/camera configure",
    "node info": "/robot",
    "node list": "",
    "param delete": "/robot speed",
    "param describe": "/robot speed",
    "param dump": "/robot",
    "param get": "/robot speed",
    "param list": "",
    "param list /robot": "/robot",
    "param load": "/robot robot.yaml",
    "param set": "/robot speed 0.1",
    "service call": f"/robot/get_parameters {GET}",
    "service echo": f"/robot/get_parameters {GET}",
    "service find": GET,
    "service info": "/robot/get_parameters",
    "service list": "",
    "service type": "/robot/get_parameters",
    "top": "--once",
    "top --json": "--json",
    "topic bw": "/imu",
    "topic delay": "/imu",
    "topic echo": "/imu",
    "topic echo of a type": "/imu sensor_msgs/msg/Imu",
    "topic find": "sensor_msgs/msg/Imu",
    "topic hz": "/imu",
    "topic info": "/imu",
    "topic list": "",
    "topic pub": "/cmd_vel geometry_msgs/msg/Twist",
    "topic pub --once": "--once /cmd_vel geometry_msgs/msg/Twist",
    "topic type": "/imu",
}
"""The arguments of each verb; its name is the first words that are a command."""

OTHERS = {"admit", "doctor", "graph", "launch", "nodl conform", "nodl describe", "nodl observe", "run"}
"""Commands for which `running.elsewhere` or `beside` tells."""

LONELY = {
    *("bag check", "bag migrate", "demo", "interface proto", "policy router", "policy sros2", "policy zenoh"),
    "test",
}
"""Commands that look for nobody."""


class Said(Exception):
    """Ends a verb that would wait for ever."""


@pytest.fixture
def elsewhere(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Five nodes on the real rclpy; returns what has been said."""
    said: list[str] = []

    def say(text: str) -> None:
        said.append(text)
        raise Said

    monkeypatch.setattr(neighbours, "_is_off", lambda: False)
    monkeypatch.setattr(neighbours, "_ports_of", lambda _: [7410])
    nodes = {int(os.environ["ROS_DOMAIN_ID"]): Nodes(5, is_least=True)}
    monkeypatch.setattr(neighbours, "on_real_rclpy", lambda: nodes)
    monkeypatch.setattr(neighbours, "_everybody", {"rclpy": nodes, "local": {}}.__getitem__)
    monkeypatch.setattr(neighbours, "on_local", lambda _=None: {})
    monkeypatch.setattr(lookout, "_say", say)
    return said


def verbs() -> Iterator[str]:
    """All commands that have `--transport`."""
    context = click.Context(commands)
    for name in commands.list_commands(context):
        command = commands.get_command(context, name)
        assert command is not None
        group = command.commands if isinstance(command, click.Group) else {}
        for words, each in ((name, command), *((f"{name} {verb}", each) for verb, each in group.items())):
            if any("--transport" in option.opts for option in each.params):
                yield words


def command_of(row: str) -> str:
    return next(
        verb for verb in (row, " ".join(row.split()[:2]), row.split(maxsplit=1)[0]) if verb in verbs()
    )


def test_the_table_has_every_verb() -> None:
    assert {command_of(row) for row in VERBS} | OTHERS | LONELY == set(verbs())


@pytest.mark.parametrize("row", VERBS)
def test_who_finds_nobody_is_told(row: str, elsewhere: list[str], ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("/robot:\n  ros__parameters:\n    speed: 0.1\n")
    with Recorder(tmp_path / "bag") as recorder:
        recorder.write("/mode", String(data="walk"), 0)
    error = ""
    with contextlib.suppress(Said):
        error = ifgen(*command_of(row).split(), *VERBS[row].split(), "--transport", "local").err
    assert SENTENCE in error or elsewhere == [SENTENCE]
