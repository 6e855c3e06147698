"""`ifgen action list`, `type`, `find` and `info`: what the graph tells."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from ifgen.nodl.model import Category

from ifgen_tools.graph.lookup import of_type, pick, print_named
from ifgen_tools.graph.reading import Named, View, actions
from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.session import TransportChoice


def list_actions(
    *,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    show_types: bool = False,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print the actions that there are now."""
    with open_session(transport) as session:
        session.discover(spin_time)
        found = actions(session.node)
    print_named(found, show_types=show_types, count=count, as_json=as_json)


def print_type(
    *,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    as_json: bool = False,
) -> None:
    """Print the type of an action, or the types. Raises ToolError if there is no such action."""
    with open_session(transport) as session:
        session.discover(spin_time)
        found = pick_action(session.node, name)
    print(json.dumps(found.types) if as_json else "\n".join(found.types))


def find_actions(
    *,
    type_name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print the actions of a type: nothing if there is none."""
    with open_session(transport) as session:
        session.discover(spin_time)
        found = actions(session.node)
    print_named(of_type(found, type_name, "action"), count=count, as_json=as_json)


def action_info(
    *,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    show_types: bool = False,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print who serves an action, and who has a client of it. Raises ToolError if there is no such action."""
    with open_session(transport) as session:
        session.discover(spin_time)
        found = pick_action(session.node, name)
        view = session.graph()
    clients = _nodes(view, found.name, Category.ACTION_CLIENT)
    servers = _nodes(view, found.name, Category.ACTION_SERVER)
    if as_json:
        lists = {"clients": list(map(asdict, clients)), "servers": list(map(asdict, servers))}
        print(json.dumps({"name": found.name, **lists}, indent=2))
        return
    print(f"Action: {found.name}")
    for what, nodes in (("clients", clients), ("servers", servers)):
        print(f"Action {what}: {len(nodes)}")
        for each in [] if count else nodes:
            print(f"    {each.name} [{', '.join(each.types)}]" if show_types else f"    {each.name}")


def pick_action(node: Node, name: str) -> Named:
    """The action of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(actions(node), name, "action")


def _nodes(view: View, action: str, category: Category) -> list[Named]:
    """The nodes that have an action, or clients of it, with the types there."""
    types: dict[str, list[str]] = {}
    for end in view.ends(action, category):
        types.setdefault(end.node, []).append(end.type_name)
    return [Named(node, of_node) for node, of_node in types.items()]
