"""`ifgen node list` and `info`."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from typing import Final

from ifgen.command_kit.tool import ToolError
from ifgen.nodl.model import Category

from ifgen_tools.ros_graph import is_hidden, node_names, of_node
from ifgen_tools.session import find_node, open_session
from ifgen_tools.verbs import ListOptions, NodeOptions

_HEADINGS: Final = {
    Category.SUBSCRIPTION: "Subscribers",
    Category.PUBLISHER: "Publishers",
    Category.SERVICE_SERVER: "Service Servers",
    Category.SERVICE_CLIENT: "Service Clients",
    Category.ACTION_SERVER: "Action Servers",
    Category.ACTION_CLIENT: "Action Clients",
}
"""The words of ROS, in the order in which it prints them."""


def list_nodes(chosen: ListOptions) -> None:
    """Print the names of all nodes."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        names = node_names(session.node, chosen.include_hidden)
    if chosen.count:
        print(len(names))
    elif chosen.as_json:
        print(json.dumps(names, indent=2))
    else:
        for name in names:
            print(name)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        print(f"warning: more than one node is called {', '.join(twice)}", file=sys.stderr)


def show_node(chosen: NodeOptions) -> None:
    """Print the topics, services and actions of a node."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        name = find_node(session, chosen.node, chosen.spin_time)
        try:
            has = of_node(session.node, name)
        except RuntimeError:
            raise ToolError(f"the node {name!r} has just gone") from None
    lists = {
        heading: [each for each in has[category] if chosen.include_hidden or not is_hidden(each.name)]
        for category, heading in _HEADINGS.items()
    }
    if chosen.as_json:
        plain = {heading.lower().replace(" ", "_"): list(map(asdict, of)) for heading, of in lists.items()}
        print(json.dumps({"name": name, **plain}, indent=2))
        return
    print(name)
    for heading, of in lists.items():
        print(f"  {heading}:")
        print("\n".join(f"    {each.name}: {', '.join(each.types)}" for each in of))
