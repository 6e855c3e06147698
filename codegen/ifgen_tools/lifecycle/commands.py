"""The verbs of `ifgen lifecycle`, which read their options and leave the work to a module each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click
from ifgen.command_kit import options
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.lifecycle.options import GetOptions, SetOptions, TransitionsOptions
from ifgen_tools.verbs import ListOptions, takes

# Late imports: each verb loads what it needs.

Command = Callable[..., Any]


@click.group(cls=ToolGroup)
def lifecycle() -> None:
    """Look at the states of lifecycle nodes, and change them."""


def _shared(command: Command) -> Command:
    """The options of every verb, as in ROS."""
    for option in (options.json_option, options.use_sim_time_option, options.graph_options):
        command = option(command)
    return command


@lifecycle.command(epilog="Example: `ifgen lifecycle nodes`")
@_shared
@click.option("-a", "--all", "include_hidden", is_flag=True, help="Hidden nodes as well.")
@click.option("-c", "--count-nodes", "count", is_flag=True, help="Only how many there are.")
@takes(ListOptions)
def nodes(chosen: ListOptions) -> int:
    """Print the names of all lifecycle nodes."""
    from ifgen_tools.lifecycle.states import list_nodes

    return list_nodes(chosen)


@lifecycle.command(epilog="Example: `ifgen lifecycle get /camera_driver`")
@click.argument("node", required=False, shell_complete=completion.nodes)
@_shared
@options.hidden_nodes_option
@takes(GetOptions)
def get(chosen: GetOptions) -> int:
    """Print the state of a lifecycle node, or of all of them."""
    from ifgen_tools.lifecycle.states import get_states

    return get_states(chosen)


@lifecycle.command("list", epilog="Example: `ifgen lifecycle list /camera_driver`")
@click.argument("node", shell_complete=completion.nodes)
@_shared
@options.hidden_nodes_option
@click.option("-a", "--all", "all_", is_flag=True, help="Those of all states, not only of the present one.")
@takes(TransitionsOptions)
def list_(chosen: TransitionsOptions) -> int:
    """Print the transitions of a lifecycle node."""
    from ifgen_tools.lifecycle.states import list_transitions

    return list_transitions(chosen)


@lifecycle.command("set", epilog="Example: `ifgen lifecycle set /camera_driver configure`")
@click.argument("node", shell_complete=completion.nodes)
@click.argument("transition", shell_complete=completion.transitions)
@_shared
@options.hidden_nodes_option
@takes(SetOptions)
def set_(chosen: SetOptions) -> int:
    """Let a lifecycle node go through a transition, which is given by its label or number."""
    from ifgen_tools.lifecycle.states import set_state

    return set_state(chosen)
