"""The handle of a node: its resolved name, its arguments, and its place in the graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from rmw_local.graph import GraphNode

from . import graph
from .arguments import Arguments, parse_node_arguments
from .context import Context
from .handle import Destroyable, RCLError, as_bool
from .names import (
    as_c_string,
    expand_name,
    rclpy_get_validation_error_for_full_topic_name,
    rclpy_get_validation_error_for_namespace,
    rclpy_get_validation_error_for_node_name,
)
from .qos import profile_of
from .rosout import rosout_connect
from .rules import RemapKind, RemapRule, remapped_name, remapped_topic

NamesAndTypes = list[tuple[str, list[str]]]


class Node(Destroyable):
    """A node of a context. Raises ValueError for a bad name or namespace, RCLError in a context that is down.

    Rules in the node's own arguments come before those of the process, and the first match counts.
    """

    def __init__(
        self,
        node_name: str,
        namespace: str,
        context: Context,
        cli_args: list[str] | None,
        use_global_arguments: bool,
        enable_rosout: bool,
        rosout_qos_profile: object = None,
    ) -> None:
        super().__init__()
        if not isinstance(context, Context):
            raise TypeError(f"expected a context handle, got {context!r}")
        as_bool(use_global_arguments, "use_global_arguments")
        own = Arguments() if cli_args is None else parse_node_arguments(cli_args)
        if not context.ok():
            raise RCLError("error creating node: the given context is not valid")
        self.context = context
        self._arguments = [own, context.arguments] if use_global_arguments else [own]
        self._rules: list[RemapRule] = [rule for args in self._arguments for rule in args.remap_rules]
        name = as_c_string(node_name, "error creating node: name argument is null")
        _check(name, "node name", rclpy_get_validation_error_for_node_name)
        name = remapped_name(self._rules, RemapKind.NODE_NAME, name) or name
        namespace = as_c_string(namespace, "error creating node: namespace argument is null")
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        _check(namespace, "node namespace", rclpy_get_validation_error_for_namespace)
        namespace = remapped_name(self._rules, RemapKind.NAMESPACE, name) or namespace
        if error := rclpy_get_validation_error_for_namespace(namespace):
            raise RCLError(f"error creating node: invalid node namespace: {error[0]}")
        context.participant.domain.close_pending()  # a forgotten node of this name is no twin
        self.graph_node: GraphNode = context.participant.create_node(
            name, namespace, context.arguments.enclave
        )
        self._closers: list[Callable[[], None]] = []
        rosout_qos = None if rosout_qos_profile is None else profile_of(rosout_qos_profile)
        if as_bool(enable_rosout, "enable_rosout") and (disconnect := rosout_connect(self, rosout_qos)):
            self.at_destruction(disconnect)

    def at_destruction(self, close: Callable[[], None]) -> None:
        """Call `close` when the node leaves the graph."""
        self._closers.append(close)

    def _on_destroy(self) -> None:
        _leave(self._closers, self.graph_node)

    def __del__(self) -> None:
        # A collector may run while this thread holds any lock: leaving has to wait until somebody looks.
        if hasattr(self, "_closers") and not self._destroyed:
            self.graph_node.participant.domain.close_later(partial(_leave, self._closers, self.graph_node))

    # Names

    def get_node_name(self) -> str:
        """Return the name, remapped."""
        return self.graph_node.name

    def get_namespace(self) -> str:
        """Return the namespace, remapped and absolute."""
        return self.graph_node.namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name in one."""
        return self.graph_node.full_name

    def logger_name(self) -> str:
        """Return the name of the node's logger: the full name, its tokens joined by dots."""
        return self.graph_node.full_name.strip("/").replace("/", ".")

    def remap_name(self, full_name: str, *, is_service: bool) -> str:
        """Apply the remap rules to an absolute name."""
        if not self._rules:
            return full_name
        return remapped_topic(
            self._rules,
            full_name,
            is_service=is_service,
            node_name=self.graph_node.name,
            namespace=self.graph_node.namespace,
        )

    def resolve_name(self, name: str, *, is_service: bool, only_expand: bool = False) -> str:
        """Return the name that an endpoint of this node called `name` gets; raises ValueError."""
        name = as_c_string(name, "failed to resolve name: input_topic_name argument is null")
        resolved = expand_name(name, self.graph_node.name, self.graph_node.namespace)
        if not only_expand:
            resolved = self.remap_name(resolved, is_service=is_service)
        if error := rclpy_get_validation_error_for_full_topic_name(resolved):
            raise ValueError(error[0])
        return resolved

    # Parameters

    def get_parameters(self, pyparameter_cls: Callable[..., Any]) -> dict[str, Any]:
        """Return the overrides for this node by name, as instances of the given class."""
        full_name = self.graph_node.full_name
        self.use_parameters(())
        return {
            name: pyparameter_cls(name, value=value)
            for arguments in reversed(self._arguments)
            for name, value in arguments.parameters.matching(full_name)
        }

    def use_parameters(self, names: Iterable[str] | None) -> None:
        """Note which overrides the node knows, so that the others can be named; None: all of them."""
        for arguments in self._arguments:
            arguments.parameters.use(self.graph_node.full_name, names)

    # The graph around it

    def get_count_publishers(self, topic_name: str) -> int:
        """Count the publishers of an absolute topic name."""
        return graph.count_publishers(self, topic_name)

    def get_count_subscribers(self, topic_name: str) -> int:
        """Count the subscriptions of an absolute topic name."""
        return graph.count_subscribers(self, topic_name)

    def get_count_clients(self, service_name: str) -> int:
        """Count the clients of an absolute service name."""
        return graph.count_clients(self, service_name)

    def get_count_services(self, service_name: str) -> int:
        """Count the servers of an absolute service name."""
        return graph.count_services(self, service_name)

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return (name, namespace) of every node."""
        return [
            (name, namespace) for name, namespace, _ in self.get_node_names_and_namespaces_with_enclaves()
        ]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return (name, namespace, enclave) of every node."""
        return graph.node_names(self)

    def get_action_names_and_types(self) -> NamesAndTypes:
        """Return every action and its types."""
        return graph.action_names_and_types(self)

    def get_action_client_names_and_types_by_node(
        self, remote_node_name: str, remote_node_namespace: str
    ) -> NamesAndTypes:
        """Return the actions that a node has clients for."""
        return graph.action_client_names_and_types_by_node(self, remote_node_name, remote_node_namespace)

    def get_action_server_names_and_types_by_node(
        self, remote_node_name: str, remote_node_namespace: str
    ) -> NamesAndTypes:
        """Return the actions that a node serves."""
        return graph.action_server_names_and_types_by_node(self, remote_node_name, remote_node_namespace)


def _leave(closers: list[Callable[[], None]], graph_node: GraphNode) -> None:
    for close in closers:
        close()
    graph_node.close()


def _check(name: str, what: str, error_of: Callable[[str], tuple[str, int] | None]) -> None:
    if error := error_of(name):
        raise ValueError(f"invalid {what}: {error[0]}")


def rclpy_resolve_name(node: Node, name: str, only_expand: bool, is_service: bool) -> str:
    """The name that an endpoint of `node` called `name` really gets: expanded, then remapped.

    Raises RCLError.
    """
    _check_node(node)
    try:
        return node.resolve_name(name, only_expand=only_expand, is_service=is_service)
    except ValueError as error:
        raise RCLError(f"failed to resolve name: {error}") from None


def rclpy_remap_topic_name(node: Node, name: str) -> str:
    """`name` (absolute) after the topic rules of the node, or unchanged when no rule matches."""
    _check_node(node)
    return node.remap_name(as_c_string(name, "failed to remap topic name: name is null"), is_service=False)


def _check_node(node: object) -> None:
    if not isinstance(node, Node):
        raise TypeError(f"expected a node handle, got {node!r}")
