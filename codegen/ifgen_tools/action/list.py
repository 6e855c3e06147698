"""`ifgen action list`, `type`, `find` and `info`: the actions in the graph."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ifgen_tools.named import Named, named, of_type, pick, print_named
from ifgen_tools.names import full_name
from ifgen_tools.session import open_session
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions

if TYPE_CHECKING:
    from rclpy.node import Node

# Late imports: rclpy is found once the transport has been chosen.


def list_actions(chosen: ListOptions) -> None:
    """Print the actions that there are now."""
    with open_session(chosen.transport) as session:
        session.discover(chosen.spin_time)
        found = actions(session.node)
    print_named(found, show_types=chosen.show_types, count=chosen.count, as_json=chosen.as_json)


def print_type(chosen: NameOptions) -> None:
    """Print the type of an action, or the types. Raises ToolError if there is no such action."""
    with open_session(chosen.transport) as session:
        session.discover(chosen.spin_time)
        found = pick_action(session.node, chosen.name)
    print(json.dumps(found.types) if chosen.as_json else "\n".join(found.types))


def find_actions(chosen: FindOptions) -> None:
    """Print the actions of a type: nothing if there is none."""
    with open_session(chosen.transport) as session:
        session.discover(chosen.spin_time)
        found = actions(session.node)
    print_named(of_type(found, chosen.type_name, "action"), count=chosen.count, as_json=chosen.as_json)


def action_info(chosen: NameOptions) -> None:
    """Print who serves an action, and who has a client of it. Raises ToolError if there is no such action."""
    with open_session(chosen.transport) as session:
        session.discover(chosen.spin_time)
        import rclpy.action

        node = session.node
        found = pick_action(node, chosen.name)
        clients = _nodes_with(found.name, node, rclpy.action.get_action_client_names_and_types_by_node)
        servers = _nodes_with(found.name, node, rclpy.action.get_action_server_names_and_types_by_node)
    if chosen.as_json:
        lists = {"clients": list(map(asdict, clients)), "servers": list(map(asdict, servers))}
        print(json.dumps({"name": found.name, **lists}, indent=2))
        return
    print(f"Action: {found.name}")
    for what, nodes in (("clients", clients), ("servers", servers)):
        print(f"Action {what}: {len(nodes)}")
        for each in [] if chosen.count else nodes:
            print(f"    {each.name} [{', '.join(each.types)}]" if chosen.show_types else f"    {each.name}")


def actions(node: Node) -> list[Named]:
    """The actions that a node sees, sorted by name."""
    import rclpy.action

    return named(rclpy.action.get_action_names_and_types(node))


def pick_action(node: Node, name: str) -> Named:
    """The action of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(actions(node), name, "action")


def _nodes_with(action: str, node: Node, ask: Callable[[Node, str, str], Any]) -> list[Named]:
    """The nodes whose servers or clients, as `ask` tells, include this action; with the types there."""
    from rclpy.node import NodeNameNonExistentError

    found: list[Named] = []
    for name, namespace in node.get_node_names_and_namespaces():
        try:
            known = ask(node, name, namespace)
        except NodeNameNonExistentError:  # has gone since
            continue
        found += (Named(full_name(name, namespace), list(types)) for each, types in known if each == action)
    return sorted(found, key=lambda each: each.name)
