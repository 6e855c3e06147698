"""Defaults of the nodes that start later, to the end of the group."""

from __future__ import annotations

from typing import Any

from launch.action import Action
from launch.condition import Condition
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import performed

from launch_ros.parameter_descriptions import ParameterFile
from launch_ros.utilities import evaluate_one, make_namespace_absolute, prefix_namespace, value_of


class PushRosNamespace(Action):
    """A namespace around that of each node, inside those that were pushed before."""

    def __init__(self, namespace: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        """Push it. Raises RuntimeError."""
        outer = context.launch_configurations.get("ros_namespace")
        found = prefix_namespace(outer, performed(context, self.namespace))
        context.launch_configurations["ros_namespace"] = make_namespace_absolute(found or "")


class SetRemap(Action):
    """A remapping for each node, before its own ones."""

    def __init__(
        self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.src = src
        self.dst = dst

    def execute(self, context: LaunchContext) -> None:
        """Add it."""
        _add(context, "ros_remaps", (performed(context, self.src), performed(context, self.dst)))


class SetParameter(Action):
    """A parameter for each node, which its own ones override."""

    def __init__(
        self, name: SomeSubstitutionsType, value: Any, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.name = name
        self.value = value

    def execute(self, context: LaunchContext) -> None:
        """Add it. Raises TypeError."""
        _add(context, "global_params", (performed(context, self.name), value_of(context, self.value)))


class SetUseSimTime(SetParameter):
    """The parameter `use_sim_time` for each node."""

    def __init__(self, value: bool | SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__("use_sim_time", value, condition=condition)


class SetParametersFromFile(Action):
    """A parameter file for each node, which its own parameters override."""

    def __init__(
        self, filename: SomeSubstitutionsType | ParameterFile, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.filename = filename

    def execute(self, context: LaunchContext) -> None:
        """Add it."""
        _add(context, "global_params", str(evaluate_one(context, self.filename)))


class SetROSLogDir(Action):
    """The folder for the log files of each node."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.new_log_dir = new_log_dir

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.environment["ROS_LOG_DIR"] = performed(context, self.new_log_dir)


def _add(context: LaunchContext, name: str, value: Any) -> None:
    """Add to a list that other contexts of groups may hold as well."""
    context.launch_configurations[name] = [*context.launch_configurations.get(name, ()), value]
