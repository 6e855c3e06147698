# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Containers of composable nodes. They are programs in C++: where none is installed, the launch says so."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from launch._errors import LaunchError
from launch.action import Action
from launch.condition import Condition
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.logging import get_logger
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions, performed

from launch_ros.actions.node import Node
from launch_ros.descriptions import ComposableNode
from launch_ros.utilities import evaluate_one, make_namespace_absolute, prefix_namespace

_LOGGER = "launch_ros.actions.composable_node_container"


class ComposableNodeContainer(Node):
    """A container, and the nodes that it loads when it has started."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        composable_node_descriptions: Sequence[ComposableNode] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.composable_node_descriptions = list(composable_node_descriptions or ())

    def describe_sub_entities(self) -> Sequence[LaunchDescriptionEntity]:
        """Return the action that loads its nodes."""
        return self._loading()

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Start the container, if it is installed, and return the action that loads its nodes."""
        try:
            if self.package is not None:
                context.packages.prefix(perform_substitutions(context, self.package))
        except (LookupError, LaunchError) as error:
            return self._leave_out(context, error)
        super().execute(context)
        return self._loading()

    def _leave_out(self, context: LaunchContext, error: Exception) -> list[LaunchDescriptionEntity]:
        self.expand_names(context)
        name = f"{self.expanded_node_namespace.removesuffix('/')}/{self.expanded_node_name}"
        missing = context.get_globals_as_dict().get("missing_containers", ())
        context.extend_globals({"missing_containers": (*missing, name, self.expanded_node_name)})
        nodes = [_label(context, each) for each in self.composable_node_descriptions]
        _warn(nodes, f"no container runs: {_first_line(error)}")
        context.host.completed(self)
        return []

    def _loading(self) -> list[LaunchDescriptionEntity]:
        nodes = self.composable_node_descriptions
        if not nodes:
            return []
        return [LoadComposableNodes(composable_node_descriptions=nodes, target_container=self)]


class LoadComposableNodes(Action):
    """Loads nodes into a container, by its action or by its name, one after the other."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Sequence[ComposableNode],
        target_container: SomeSubstitutionsType | ComposableNodeContainer,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.composable_node_descriptions = list(composable_node_descriptions)
        self.target_container = target_container

    def describe(self) -> str:
        """Return the nodes."""
        names = (described(each.node_plugin) for each in self.composable_node_descriptions)
        return f"LoadComposableNodes({', '.join(names)})"

    def execute(self, context: LaunchContext) -> None:
        """Ask the container for each node whose condition holds. Raises TypeError."""
        target = self.target_container
        nodes = [each for each in self.composable_node_descriptions if _holds(each, context)]
        name = target.node_name if isinstance(target, ComposableNodeContainer) else performed(context, target)
        if name in context.get_globals_as_dict().get("missing_containers", ()):
            _warn([_label(context, each) for each in nodes], f"the container '{name}' does not run")
            return
        loads = [_load(context, each) for each in nodes]
        if not loads:
            return
        # It imports an rclpy, which few launches need.
        from composition_interfaces.srv import LoadNode

        from launch_ros.ros_adapters import get_ros_adapter

        adapter = get_ros_adapter(context)
        client = adapter.ros_node.create_client(LoadNode, f"{name}/_container/load_node")

        def work() -> None:
            for load in loads:
                answer = adapter.call(client, load.request(LoadNode.Request()), lambda: True)
                if answer is None:
                    return
                context.host.post(lambda load=load, answer=answer: _report(load, answer, name))  # type: ignore[misc]  # bound now

        adapter.work(work)


@dataclass(frozen=True, slots=True)
class _Load:
    """A node to load, with its substitutions performed."""

    package: str
    plugin: str
    name: str
    namespace: str
    remappings: list[str]
    parameters: dict[str, Any]
    extra: dict[str, Any]

    def request(self, request: Any) -> Any:
        """Fill a request of the service `load_node`."""
        from rclpy.parameter import Parameter  # as above

        request.package_name, request.plugin_name = self.package, self.plugin
        request.node_name, request.node_namespace = self.name, self.namespace
        request.remap_rules = self.remappings
        request.parameters = [
            Parameter(name, value=value).to_parameter_msg() for name, value in self.parameters.items()
        ]
        request.extra_arguments = [
            Parameter(name, value=value).to_parameter_msg() for name, value in self.extra.items()
        ]
        return request


def _load(context: LaunchContext, node: ComposableNode) -> _Load:
    given = None if node.node_namespace is None else perform_substitutions(context, node.node_namespace)
    namespace = prefix_namespace(context.launch_configurations.get("ros_namespace"), given)
    remaps: Iterable[tuple[Any, Any]] = [
        *context.launch_configurations.get("ros_remaps", ()),
        *((performed(context, old), performed(context, new)) for old, new in node.remappings),
    ]
    name = "" if node.node_name is None else perform_substitutions(context, node.node_name)
    whole = make_namespace_absolute(namespace) if namespace else ""
    globally = context.launch_configurations.get("global_params", ())
    parameters: list[Any] = [*(dict([each]) if isinstance(each, tuple) else Path(each) for each in globally)]
    parameters += [evaluate_one(context, each) for each in node.parameters]
    return _Load(
        package=perform_substitutions(context, node.package),
        plugin=perform_substitutions(context, node.node_plugin),
        name=name,
        namespace=whole,
        remappings=[f"{old}:={new}" for old, new in remaps],
        parameters=_merged(parameters, f"{whole.removesuffix('/')}/{name}"),
        extra=_merged([evaluate_one(context, each) for each in node.extra_arguments], ""),
    )


def _merged(given: Iterable[Any], node: str) -> dict[str, Any]:
    """Put parameters together, those of files as far as they are for this node."""
    found: dict[str, Any] = {}
    for each in given:
        if isinstance(each, Path):
            from rclpy.parameter import parameter_dict_from_yaml_file  # as above

            values: Any = parameter_dict_from_yaml_file(str(each), True, target_nodes=[node], namespace="")
            found |= {name: value.value for name, value in values.items()}
        else:
            found |= each
    return found


def _report(load: _Load, answer: Any, container: str) -> None:
    logger = get_logger("launch_ros.actions.load_composable_nodes")
    if answer.success:
        logger.info(f"Loaded node '{answer.full_node_name}' in container '{container}'")
        return
    logger.error(
        f"Failed to load node '{load.name}' of type '{load.plugin}' in container '{container}': "
        f"{answer.error_message}"
    )


def _holds(node: ComposableNode, context: LaunchContext) -> bool:
    condition = node.condition()
    return condition is None or condition.evaluate(context)


def _label(context: LaunchContext, node: ComposableNode) -> str:
    return perform_substitutions(
        context, node.node_name or normalize_to_list_of_substitutions(node.node_plugin)
    )


def _warn(nodes: list[str], reason: str) -> None:
    which = f"the composable nodes {', '.join(nodes)} do not run" if nodes else "no composable node runs"
    get_logger(_LOGGER).warning(f"{which}: {reason}")


def _first_line(error: Exception) -> str:
    text = str(getattr(error, "message", "") or (error.args[0] if error.args else error))
    return text.partition("\n")[0]
