"""The nodes of the demo, and how they share processes.

On the local transport everything runs in one process and one executor. Real rclpy is far slower, so there
each group has a process; `python -m humanoid.show.crew '{}' '{}' motion` runs one of them. Its executor
checks all entities of its nodes whenever a message arrives. Nodes that receive the sensors 250 times a second
therefore share no process with nodes that do not.
"""

from __future__ import annotations

import contextlib
import gc
import json
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from types import FrameType, MappingProxyType
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter

from ..ros import quick_executor
from ..ros.running import until_shutdown
from . import replacing
from .scenarios import Parameters

SIMULATOR = "humanoid_simulator"

EXTRA = ("camera_driver", "face_detection", "obstacle_mapper")
"""Nodes that run only where the robot sees."""

PHYSICS = "physics"
"""The group that makes time; a timer paces it, to the millisecond."""

GROUPS: dict[str, tuple[str, ...]] = {
    PHYSICS: (SIMULATOR,),
    "motion": (
        "joint_state_publisher",
        "imu_fusion",
        "whole_body_controller",
        "joint_controller",
        "gait_planner",
    ),
    "limbs": ("inverse_kinematics_server", "dance_action_server"),
    "tasks": (
        "emergency_stop",
        "battery_monitor",
        "motion_planner",
        "speech_recognition",
        "footstep_planner",
        "footstep_generation_server",
        "navigation_action_server",
        "high_level_task_manager",
        "teleop",
    ),
    "sight": ("camera_driver", "face_detection", "obstacle_mapper"),
}
"""Nodes by process; each is in the package of its name."""

MANAGED = ("camera_driver", "joint_controller")
"""Nodes with a lifecycle: whoever starts them activates them."""

WITH_BODY = (
    SIMULATOR,
    "joint_state_publisher",
    "imu_fusion",
    "whole_body_controller",
    "joint_controller",
    "inverse_kinematics_server",
    "gait_planner",
    "footstep_generation_server",
    "navigation_action_server",
    "dance_action_server",
    "high_level_task_manager",
    "obstacle_mapper",
    "footstep_planner",
)
"""Nodes that load the robot's model: their parameters `model_file` and `joint_map` say which."""

ALL = "all"


def make(
    names: Iterable[str], parameters: Parameters, replaced: Mapping[str, str] = MappingProxyType({})
) -> list[Node]:
    """Make these nodes. All but the simulator, which produces it, use simulated time.

    `replaced` has files or modules with somebody's own node instead. Raises ReplacementError.
    """
    return [_make(name, dict(parameters.get(name, {})), replaced.get(name)) for name in names]


def _make(name: str, values: dict[str, Any], replacement: str | None) -> Node:
    if name != SIMULATOR:
        values["use_sim_time"] = True
    make_node: Callable[..., Node] = (
        node_class(name) if replacement is None else replacing.node_class(replacement)
    )
    overrides = [Parameter(key, value=value) for key, value in values.items()]
    node = make_node(parameter_overrides=overrides)
    if isinstance(node, LifecycleNode):
        node.trigger_configure()
        node.trigger_activate()
    return node


def node_class(name: str) -> Callable[..., Node]:
    """The class of one of the robot's nodes, which is in the package of its name."""
    found: Callable[..., Node] = getattr(import_module(f"{name}.{name}"), name.title().replace("_", ""))
    return found


def all_nodes() -> list[str]:
    """The names of all nodes of the robot."""
    return [name for names in GROUPS.values() for name in names]


def chosen(names: str, without: str = "") -> list[str]:
    """The nodes that lists with commas ask for; `ALL` are all. Raises ReplacementError."""
    known = all_nodes()
    wanted = known if names == ALL else _listed(names, known)
    left_out = _listed(without, known)
    return [name for name in wanted if name not in left_out]


def _listed(names: str, known: list[str]) -> list[str]:
    return [replacing.checked(name.strip(), known) for name in names.split(",") if name.strip()]


def members(group: str, *, with_extra: bool) -> tuple[str, ...]:
    """The nodes of a group."""
    return tuple(name for name in GROUPS[group] if with_extra or name not in EXTRA)


def main() -> None:
    """Run nodes of a group until Ctrl-C; the arguments are parameters and replaced ones, group and nodes."""
    parameters, replaced, group, *names = sys.argv[1:]
    nodes: list[Node] = []
    with contextlib.suppress(KeyboardInterrupt):  # whenever it comes
        signal.signal(signal.SIGINT, _interrupt)
        threading.Thread(target=_end_with_parent, daemon=True).start()
        rclpy.init(args=[])
        with until_shutdown():
            executor = SingleThreadedExecutor() if group == PHYSICS else quick_executor.make()
            nodes += make(names or GROUPS[group], json.loads(parameters), json.loads(replaced))
            for node in nodes:
                executor.add_node(node)
            # The present objects stay alive: the collector need not examine them again, which takes 20 ms.
            gc.freeze()
            executor.spin()
    signal.signal(signal.SIGINT, _ignore)
    for node in nodes:
        node.destroy_node()
    rclpy.try_shutdown()


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, once: terminal, parent and stdin may each send the signal."""
    signal.signal(signal.SIGINT, _ignore)
    raise KeyboardInterrupt


def _ignore(number: int, frame: FrameType | None) -> None:
    """Do nothing. Unlike SIG_IGN it may be set while a signal is on its way."""


def _end_with_parent() -> None:
    """Interrupt this process when the process at the other end of stdin is gone."""
    if not sys.stdin.isatty():
        sys.stdin.read()
        signal.raise_signal(signal.SIGINT)


if __name__ == "__main__":
    main()
