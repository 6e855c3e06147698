"""The actions in the graph, and the nodes that serve or use them."""

from __future__ import annotations

from rclpy.node import Node

NamesAndTypes = list[tuple[str, list[str]]]


def get_action_client_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """Return (action, types) of everything that a node has action clients for.

    :param node: the node that asks.
    :param remote_node_name: the name of the node that is asked about.
    :param remote_node_namespace: its namespace.
    :raises NodeNameNonExistentError: if there is no such node.
    """
    with node.handle:
        names: NamesAndTypes = node.handle.get_action_client_names_and_types_by_node(
            remote_node_name, remote_node_namespace
        )
        return names


def get_action_server_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """Return (action, types) of everything that a node serves.

    :param node: the node that asks.
    :param remote_node_name: the name of the node that is asked about.
    :param remote_node_namespace: its namespace.
    :raises NodeNameNonExistentError: if there is no such node.
    """
    with node.handle:
        names: NamesAndTypes = node.handle.get_action_server_names_and_types_by_node(
            remote_node_name, remote_node_namespace
        )
        return names


def get_action_names_and_types(node: Node) -> NamesAndTypes:
    """Return (action, types) of every action that has a server or a client.

    :param node: the node that asks.
    """
    with node.handle:
        return node.handle.get_action_names_and_types()
