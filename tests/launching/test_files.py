"""Launch files in Python, XML and YAML: what they mean, and what is wrong with them."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from launch import LaunchContext
from launch._errors import LaunchError
from launch.launch_description_sources._reading import read

from .conftest import Recorded

PYTHON = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, GroupAction, LogInfo
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace, SetParameter

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("who", default_value="world"),
        GroupAction(
            [
                PushRosNamespace("robot"),
                SetParameter("rate", 0.1),
                Node(
                    package="battery_monitor",
                    executable="battery_monitor",
                    name="battery",
                    output="screen",
                    arguments=["--to", LaunchConfiguration("who")],
                    parameters=[{"period": 0.1, "a.b": [1, 2], "who": LaunchConfiguration("who")}],
                    remappings=[("chat", ["talk_", LaunchConfiguration("who")])],
                ),
            ],
            condition=IfCondition("true"),
        ),
        ExecuteProcess(cmd=["echo", "a b", LaunchConfiguration("who")], additional_env={"X": "1"}),
        LogInfo(msg=["hello ", LaunchConfiguration("who")]),
    ])
"""
XML = """<launch>
  <arg name="who" default="world"/>
  <group if="true">
    <push_ros_namespace namespace="robot"/>
    <set_parameter name="rate" value="0.1"/>
    <node pkg="battery_monitor" exec="battery_monitor" name="battery" output="screen" args="--to $(var who)">
      <param name="period" value="0.1"/>
      <param name="a"><param name="b" value="1,2" value-sep=","/></param>
      <param name="who" value="$(var who)"/>
      <remap from="chat" to="talk_$(var who)"/>
    </node>
  </group>
  <executable cmd="echo 'a b' $(var who)"><env name="X" value="1"/></executable>
  <log message="hello $(var who)"/>
</launch>
"""
YAML = """launch:
- arg: {name: who, default: world}
- group:
    if: true
    children:
    - push_ros_namespace: {namespace: robot}
    - set_parameter: {name: rate, value: 0.1}
    - node:
        pkg: battery_monitor
        exec: battery_monitor
        name: battery
        output: screen
        args: --to $(var who)
        param:
        - {name: period, value: 0.1}
        - name: a
          param:
          - {name: b, value: [1, 2]}
        - {name: who, value: $(var who)}
        remap:
        - {from: chat, to: talk_$(var who)}
- executable:
    cmd: echo 'a b' $(var who)
    env:
    - {name: X, value: '1'}
- log: {message: hello $(var who)}
"""
FILES = [("a.launch.py", PYTHON), ("a.launch.xml", XML), ("a.launch.yaml", YAML)]


@pytest.mark.parametrize(("name", "text"), FILES, ids=["python", "xml", "yaml"])
def test_the_three_languages_mean_the_same(
    name: str, text: str, record: Recorded, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[tuple[str, dict[str, object]]] = []

    def note(context: LaunchContext, found: dict[str, object], node: str) -> str:
        given.append((node, dict(found)))
        return "FILE"

    monkeypatch.setattr("launch_ros.actions.node.written", note)
    recorder = record(name, text, who="me")
    node, process = recorder.started
    assert node.name.startswith("battery_monitor-")
    words = list(node.command)
    files = ["--params-file", "FILE"]
    begin = words.index("--to")
    assert words[begin:][:7] == ["--to", "me", "--ros-args", "-r", "__node:=battery", "-r", "__ns:=/robot"]
    assert words[begin + 7 : begin + 9] == files
    assert words[-2:] == ["-r", "chat:=talk_me"]
    together = {key: value for _, found in given for key, value in found.items()}
    assert together == {"rate": 0.1, "period": 0.1, "a.b": [1, 2], "who": "me"}
    assert {name for name, _ in given} == {"/robot/battery"}
    assert node.stdout == {"screen"}
    assert process.command == ["echo", "a b", "me"]
    assert process.env["X"] == "1"
    assert recorder.said == ["hello me"]


@pytest.mark.parametrize(
    ("name", "text", "line", "message"),
    [
        ("a.launch.xml", "<launch>\n <nod/>\n</launch>", 2, "`ifgen launch` has no action 'nod'"),
        ("a.launch.xml", "<launch>\n <node/>\n</launch>", 2, "'node' needs the attribute 'exec'"),
        ("a.launch.xml", "<launch>\n <log mesage='a'/>\n</launch>", 2, "'log' needs the attribute 'message'"),
        ("a.launch.xml", "<launch>\n <log message='a' b='c'/>\n</launch>", 2, "'log' has no attribute 'b'"),
        ("a.launch.xml", "<launch>\n <log", 2, "this is not XML: unclosed token"),
        ("a.launch.xml", "<lunch/>", 1, "the outermost element must be 'launch', got 'lunch'"),
        ("a.launch.xml", "<launch>a</launch>", 1, "unexpected text 'a'"),
        ("a.launch.xml", "<!DOCTYPE a [<!ENTITY b 'c'>]><launch/>", 1, "entities of XML cannot be declared"),
        ("a.launch.xml", "<launch>" + "<group>" * 200, 1, "more than 100 elements within each other"),
        (
            "a.launch.xml",
            "<launch>\n <node exec='a'><node/></node></launch>",
            2,
            "'node' has no 'node' inside",
        ),
        (
            "a.launch.xml",
            "<launch>\n <group if='1' unless='1'/></launch>",
            2,
            "'group' has both 'if' and 'unless'",
        ),
        (
            "a.launch.xml",
            "<launch><node exec='a'>\n<param name='a' value='b' type='int'/></node></launch>",
            2,
            "expected a value of type int, got 'b'",
        ),
        ("a.launch.xml", "<launch><node exec='a'>\n<param value='b'/></node></launch>", 2, "'param' needs"),
        ("a.launch.yaml", "", 1, "this file is empty"),
        ("a.launch.yaml", "a: 1", 1, "expected one key 'launch'"),
        ("a.launch.yaml", "launch:\n- node: {exec: [", 2, "this is not YAML"),
        ("a.launch.yaml", "launch:\n- node: {exec: 5}", 2, "'exec' of 'node' must be a text, got 5"),
        ("a.launch.yaml", "launch:\n- node:\n  exec: a", 2, "expected an entity: one key"),
        ("a.launch.yaml", "launch:\n- &a\n  group:\n  - *a", 3, "too many elements"),
        ("a.launch.yaml", "launch:\n- log: {message: a, message: b}", 2, "the key 'message' is there twice"),
        ("a.launch.yaml", "launch:\n- arg: {name: a, default: 2026-01-01}", 2, "a value of type date"),
        ("a.launch.py", "\nimport nothing_of_the_kind", 2, "No module named 'nothing_of_the_kind'"),
        ("a.launch.py", "x = (", 1, "'(' was never closed"),
        (
            "a.launch.py",
            "\nfrom launch_ros.actions import RosTimers",
            2,
            "`ifgen launch` has no launch_ros.actions.RosTimers",
        ),
        (
            "a.launch.py",
            "\nimport launch\nlaunch.actions.ForAll()",
            3,
            "`ifgen launch` has no launch.actions.ForAll",
        ),
        ("a.launch.py", "x = 1", 1, "there is no function generate_launch_description()"),
        (
            "a.launch.py",
            "def generate_launch_description():\n    pass",
            1,
            "generate_launch_description() must return",
        ),
        (
            "a.launch.py",
            "from launch_ros.actions import Node\ndef generate_launch_description():\n    Node(executable='a', b=1)",
            3,
            "ExecuteLocal.__init__() got an unexpected keyword argument 'b'",
        ),
    ],
)
def test_mistakes(name: str, text: str, line: int, message: str, tmp_path: Path) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(LaunchError) as raised:
        read(str(file))
    assert f"{name}:{line}: {message}" in raised.value.message


@pytest.mark.parametrize(
    ("name", "message"),
    [("none.launch.py", "there is no such file"), (".", "it is a folder"), ("a.txt", "is no launch file")],
)
def test_files_that_are_none(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").touch()
    with pytest.raises(LaunchError, match=message):
        read(str(tmp_path / name))


@pytest.mark.parametrize(("name", "text"), FILES[1:], ids=["xml", "yaml"])
def test_damaged_files_have_a_meaning_or_a_mistake_with_its_place(
    name: str, text: str, tmp_path: Path
) -> None:
    chance = random.Random(16)
    file = tmp_path / name
    refused = 0
    for _ in range(250):
        damaged = list(text)
        for _ in range(chance.randrange(1, 4)):
            at = chance.randrange(len(damaged))
            damaged[at : at + chance.randrange(3)] = chance.choice(
                ["", "<", "'", "$(", ": ", "- ", "\n", "&a ", "*a", "}"]
            )
        file.write_text("".join(damaged))
        try:
            read(str(file))
        except LaunchError as error:
            refused += 1
            assert f"{name}:" in error.message
            assert "\n" not in error.message
    assert refused > 100
