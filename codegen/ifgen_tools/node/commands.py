"""The verbs of `ifgen node`, which read their options and leave the work to a module."""

from __future__ import annotations

import click
from ifgen.command_kit import options
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.verbs import ListOptions, NodeOptions, takes

# Late imports: each verb loads what it needs.


@click.group(cls=ToolGroup)
def node() -> None:
    """Look at nodes."""


@node.command("list", epilog="Example: ifgen node list")
@options.graph_options
@options.use_sim_time_option
@click.option("-a", "--all", "include_hidden", is_flag=True, help="Hidden nodes as well.")
@click.option("-c", "--count-nodes", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
@takes(ListOptions)
def list_(chosen: ListOptions) -> None:
    """Print the names of all nodes."""
    from ifgen_tools.node.show import list_nodes

    list_nodes(chosen)


@node.command(epilog="Example: ifgen node info /talker")
@click.argument("node", metavar="NODE", shell_complete=completion.nodes)
@options.graph_options
@options.use_sim_time_option
@click.option("--include-hidden", is_flag=True, help="Hidden topics, services and actions as well.")
@options.json_option
@takes(NodeOptions)
def info(chosen: NodeOptions) -> None:
    """Print the topics, services and actions of a node."""
    from ifgen_tools.node.show import show_node

    show_node(chosen)
