"""Brings the humanoid up, a process for each node, and plays a scenario to its end.

`ifgen launch humanoid humanoid.launch.py scenario:=walk`; `ros2 launch` takes the same words.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from humanoid.show import crew, scenarios
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, RegisterEventHandler, Shutdown
from launch.event_handlers import OnProcessExit
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node

IDLE = "idle"
ARGUMENTS = {
    "scenario": ("all", f"A scenario, a .yaml file of yours, or {IDLE}: stand, and wait for others"),
    "transport": ("auto", "local: without ROS; rclpy: the real one, which `ros2 launch` always takes"),
    "nodes": (crew.ALL, "The nodes to start, with commas"),
    "without": ("", "Nodes to leave out, with commas"),
    "camera": ("auto", "Whether it sees: true, false, or auto: where the scenario has obstacles"),
    "model": ("", "Your own humanoid, as MJCF; empty: ours"),
    "joint_map": ("", "Which of its joints is which, as YAML"),
    "seed": ("0", "Seed of the noise of the sensors"),
    "noise": ("true", "Whether sensors are noisy"),
    "speed": ("0.0", "Real-time factor; 0: as fast as possible"),
    "parameters": (str(scenarios.folder().parent / "humanoid.yaml"), "Parameter file of all nodes"),
}
"""Default and description of each argument."""


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments; which nodes there are depends on them."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_robot)])


def _robot(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Return the nodes, and the director, whose end is the end of all."""
    said = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    if said["transport"] not in {"auto", "local", "rclpy"}:
        raise ValueError(f"transport:={said['transport']}: expected auto, local or rclpy")
    files = [said["parameters"]]
    sees = said["camera"] != "auto" and _truth("camera", said, "auto, true or false")
    if said["scenario"] != IDLE:
        files.append(str(scenarios.find(said["scenario"])))
        sees |= said["camera"] == "auto" and scenarios.needs_eyes(scenarios.read(said["scenario"]))
    started = crew.chosen(said["nodes"], said["without"])
    if said["nodes"] == crew.ALL and not sees:
        started = [name for name in started if name not in crew.EXTRA]
    found: list[LaunchDescriptionEntity] = []
    for name in started:
        found += _with_end(_node(name, [*files, _values(name, said)]), f"{name} has ended")
    if said["scenario"] != IDLE:
        words = {"package": "humanoid", "executable": "director", "output": "screen"}
        found += _with_end(Node(**words, arguments=[said["scenario"]]), "the scenario is over")
    return found


def _with_end(node: Node, reason: str) -> list[LaunchDescriptionEntity]:
    """Return a node whose end is the end of all: the others would wait for it."""
    over = OnProcessExit(target_action=node, on_exit=[Shutdown(reason=reason)])
    return [node, RegisterEventHandler(over)]


def _node(name: str, parameters: list[Any]) -> Node:
    """Return a node of the robot; managed ones are activated."""
    words = {"package": name, "executable": name, "name": name, "namespace": "", "output": "screen"}
    if name in crew.MANAGED:
        return LifecycleNode(**words, parameters=parameters, autostart=True)
    return Node(**words, parameters=parameters)


def _values(name: str, said: dict[str, str]) -> dict[str, Any]:
    """Return what the arguments say to a node."""
    values: dict[str, Any] = {"use_sim_time": name != crew.SIMULATOR}
    if name in crew.WITH_BODY:
        paths = {"model_file": said["model"], "joint_map": said["joint_map"]}
        values |= {key: str(Path(path).resolve()) if path else "" for key, path in paths.items()}
    if name == "camera_driver":
        values["streaming"] = True
    if name == crew.SIMULATOR:
        values |= {
            "seed": _number("seed", said, int, "a whole number"),
            "noise": _truth("noise", said, "true or false"),
            "speed": _number("speed", said, float, "a number"),
        }
    return values


def _truth(name: str, said: dict[str, str], expected: str) -> bool:
    word = said[name].lower()
    if word not in {"true", "1", "false", "0"}:
        raise ValueError(f"{name}:={said[name]}: expected {expected}")
    return word in {"true", "1"}


def _number(name: str, said: dict[str, str], kind: type[Any], expected: str) -> Any:
    try:
        return kind(said[name])
    except ValueError:
        raise ValueError(f"{name}:={said[name]}: expected {expected}") from None
