# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Nodes: processes with the arguments of ROS."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.actions import ExecuteProcess
from launch.launch_context import LaunchContext
from launch.logging import get_logger
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import described, normalize_to_list_of_substitutions, performed

from launch_ros.parameter_descriptions import written
from launch_ros.utilities import checked_name, evaluate_one, make_namespace_absolute, prefix_namespace


class Node(ExecuteProcess):
    """A node: an executable of a package, or without one a program, and what it is told by --ros-args."""

    UNSPECIFIED_NODE_NAME = "<node_name_unspecified>"
    UNSPECIFIED_NODE_NAMESPACE = "<node_namespace_unspecified>"

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType,
        package: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        exec_name: SomeSubstitutionsType | None = None,
        parameters: Sequence[Any] | None = None,
        remappings: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        ros_arguments: Iterable[SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
        **kwargs: Any,
    ) -> None:
        for unknown in ("node_name", "node_executable", "node_namespace"):
            if unknown in kwargs:
                raise TypeError(f"Node has no argument '{unknown}': write {unknown.removeprefix('node_')}")
        super().__init__(cmd=[], name=exec_name, **kwargs)
        if parameters is not None and not isinstance(parameters, list | tuple):
            raise TypeError(f"parameters must be a list of dicts and files, got {parameters!r}")
        if isinstance(remappings, Mapping):
            raise TypeError(f"remappings must be a list of pairs (from, to), got {remappings!r}")
        self.package = None if package is None else normalize_to_list_of_substitutions(package)
        self.executable = normalize_to_list_of_substitutions(executable)
        self.given_name = name
        self.given_namespace = namespace
        self.parameters = list(parameters or ())
        self.remappings = list(remappings or ())
        self.ros_arguments = list(ros_arguments or ())
        self.arguments = list(arguments or ())
        self.expanded_node_name = self.UNSPECIFIED_NODE_NAME
        self.expanded_node_namespace = self.UNSPECIFIED_NODE_NAMESPACE

    @property
    def node_name(self) -> str:
        """The full name of the node, as far as it is known. Raises RuntimeError before it is executed."""
        if not self._executed:
            raise RuntimeError("a node has its name when it is executed, not before")
        return f"{self.expanded_node_namespace.removesuffix('/')}/{self.expanded_node_name}"

    @property
    def is_node_name_fully_specified(self) -> bool:
        """Whether the launch file says both the name and the namespace."""
        return not {self.expanded_node_name, self.expanded_node_namespace} & {
            self.UNSPECIFIED_NODE_NAME,
            self.UNSPECIFIED_NODE_NAMESPACE,
        }

    def describe(self) -> str:
        """Return its package and its executable."""
        package = "" if self.package is None else f"package={described(self.package)}, "
        return f"{type(self).__name__}({package}executable={described(self.executable)})"

    def label_and_command(self, context: LaunchContext) -> tuple[str, list[str]]:
        """Return the name of the program, and the words that start it. Raises RuntimeError and TypeError."""
        executable = performed(context, self.executable)
        words = (
            context.packages.program(executable, context.environment.get("PATH"))
            if self.package is None
            else context.packages.executable(performed(context, self.package), executable)
        )
        own = [performed(context, word) for word in self.arguments]
        ros = [performed(context, word) for word in self.ros_arguments]
        given = [*ros, *self._ros_words(context)]
        # Each part is ended by itself: users write --ros-args among their own arguments, too.
        return Path(executable).name, [*words, *own, *(["--ros-args", *given] if given else [])]

    def expand_names(self, context: LaunchContext) -> None:
        """Perform the substitutions in its names. Raises RuntimeError."""
        if self.given_name is not None:
            self.expanded_node_name = checked_name(performed(context, self.given_name))
        own = None if self.given_namespace is None else performed(context, self.given_namespace)
        namespace = prefix_namespace(context.launch_configurations.get("ros_namespace"), own)
        if namespace is not None:
            self.expanded_node_namespace = make_namespace_absolute(namespace)

    def _ros_words(self, context: LaunchContext) -> list[str]:
        self.expand_names(context)
        words: list[str] = []
        if self.expanded_node_name != self.UNSPECIFIED_NODE_NAME:
            words += ["-r", f"__node:={self.expanded_node_name}"]
        if self.expanded_node_namespace != self.UNSPECIFIED_NODE_NAMESPACE:
            words += ["-r", f"__ns:={self.expanded_node_namespace}"]
        for given in context.launch_configurations.get("global_params", ()):
            words += self._parameters(context, dict([given]) if isinstance(given, tuple) else Path(given))
        for given in self.parameters:
            words += self._parameters(context, evaluate_one(context, given))
        remaps = [
            *context.launch_configurations.get("ros_remaps", ()),
            *((performed(context, old), performed(context, new)) for old, new in self.remappings),
        ]
        for old, new in remaps:
            words += ["-r", f"{old}:={new}"]
        return words

    def _parameters(self, context: LaunchContext, given: Path | dict[str, Any]) -> list[str]:
        if isinstance(given, dict):
            if not given:
                return []
            name = f"{self.expanded_node_namespace.removesuffix('/')}/{self.expanded_node_name}"
            node = name if self.is_node_name_fully_specified else "/**"
            return ["--params-file", written(context, given, node)]
        if not given.is_file():
            get_logger("launch_ros.actions.node").warning(f"Parameter file path is not a file: {given}")
            return []
        return ["--params-file", str(given)]
