"""`ifgen action list`, `type`, `find` and `info`: the actions in the graph."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from ifgen.nodl.model import Category

from ifgen_tools.graph.lookup import of_type, pick, print_named
from ifgen_tools.graph.reading import Named, View, actions
from ifgen_tools.session import open_session
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions

if TYPE_CHECKING:
    from rclpy.node import Node


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
        found = pick_action(session.node, chosen.name)
        view = session.graph()
    clients = _nodes(view, found.name, Category.ACTION_CLIENT)
    servers = _nodes(view, found.name, Category.ACTION_SERVER)
    if chosen.as_json:
        lists = {"clients": list(map(asdict, clients)), "servers": list(map(asdict, servers))}
        print(json.dumps({"name": found.name, **lists}, indent=2))
        return
    print(f"Action: {found.name}")
    for what, nodes in (("clients", clients), ("servers", servers)):
        print(f"Action {what}: {len(nodes)}")
        for each in [] if chosen.count else nodes:
            print(f"    {each.name} [{', '.join(each.types)}]" if chosen.show_types else f"    {each.name}")


def pick_action(node: Node, name: str) -> Named:
    """The action of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(actions(node), name, "action")


def _nodes(view: View, action: str, category: Category) -> list[Named]:
    """The nodes that have an action, or clients of it, with the types there."""
    types: dict[str, list[str]] = {}
    for end in view.ends(action, category):
        types.setdefault(end.node, []).append(end.type_name)
    return [Named(node, of_node) for node, of_node in types.items()]
