"""`ifgen node`: the nodes of a running system, and what each of them has."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Final

import click
from ifgen.nodl.model import Category

from ifgen_tools import completion, options
from ifgen_tools.errors import ToolError
from ifgen_tools.graph.lookup import find_node
from ifgen_tools.graph.reading import is_hidden, node_names, of_node
from ifgen_tools.group import ToolGroup
from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from ifgen_tools.session import TransportChoice

_HEADINGS: Final = {
    Category.SUBSCRIPTION: "Subscribers",
    Category.PUBLISHER: "Publishers",
    Category.SERVICE_SERVER: "Service Servers",
    Category.SERVICE_CLIENT: "Service Clients",
    Category.ACTION_SERVER: "Action Servers",
    Category.ACTION_CLIENT: "Action Clients",
}
"""The words of ROS, in the order in which it prints them."""


@click.group(cls=ToolGroup)
def node() -> None:
    """Look at nodes."""


@node.command("list", epilog="Example: ifgen node list")
@options.graph_options
@options.use_sim_time_option
@click.option("-a", "--all", "include_hidden", is_flag=True, help="Hidden nodes as well.")
@click.option("-c", "--count-nodes", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
def list_(
    *,
    transport: TransportChoice,
    spin_time: float | None,
    use_sim_time: bool,
    include_hidden: bool,
    count: bool,
    as_json: bool,
) -> None:
    """Print the names of all nodes."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = node_names(session.node, include_hidden)
    if count:
        print(len(found))
    elif as_json:
        print(json.dumps(found, indent=2))
    else:
        for name in found:
            print(name)
    twice = sorted({name for name in found if found.count(name) > 1})
    if twice:
        print(f"warning: more than one node is called {', '.join(twice)}", file=sys.stderr)


@node.command(epilog="Example: ifgen node info /talker")
@click.argument("node_name", metavar="NODE", shell_complete=completion.nodes)
@options.graph_options
@options.use_sim_time_option
@click.option("--include-hidden", is_flag=True, help="Hidden topics, services and actions as well.")
@options.json_option
def info(
    *,
    node_name: str,
    transport: TransportChoice,
    spin_time: float | None,
    use_sim_time: bool,
    include_hidden: bool,
    as_json: bool,
) -> None:
    """Print the topics, services and actions of a node."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        wanted = find_node(session, node_name, spin_time)
        try:
            has = of_node(session.node, wanted)
        except RuntimeError:
            raise ToolError(f"the node {wanted!r} has just gone") from None
    lists = {
        heading: [each for each in has[category] if include_hidden or not is_hidden(each.name)]
        for category, heading in _HEADINGS.items()
    }
    if as_json:
        plain = {heading.lower().replace(" ", "_"): list(map(asdict, of)) for heading, of in lists.items()}
        print(json.dumps({"name": wanted, **plain}, indent=2))
        return
    print(wanted)
    for heading, of in lists.items():
        print(f"  {heading}:")
        print("\n".join(f"    {each.name}: {', '.join(each.types)}" for each in of))
