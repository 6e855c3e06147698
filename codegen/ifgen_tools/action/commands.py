"""The verbs of `ifgen action`."""

from __future__ import annotations

import click
from ifgen.command_kit import options
from ifgen.command_kit.completion import action_types
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.verbs import CallOptions, FindOptions, ListOptions, NameOptions, takes

# Late imports: each verb loads what it needs.


@click.group(cls=ToolGroup)
def action() -> None:
    """Look at actions, and send goals."""


@action.command("list", epilog="Example: ifgen action list -t")
@options.graph_options
@click.option("-t", "--show-types", is_flag=True, help="The types as well.")
@click.option("-c", "--count-actions", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
@takes(ListOptions)
def list_(chosen: ListOptions) -> None:
    """Print the names of all actions."""
    from ifgen_tools.services import print_list

    print_list("action", chosen)


@action.command("type", epilog="Example: ifgen action type /walk")
@click.argument("name", metavar="ACTION", shell_complete=completion.actions)
@options.graph_options
@options.json_option
@takes(NameOptions)
def type_(chosen: NameOptions) -> None:
    """Print the type of an action."""
    from ifgen_tools.services import print_type

    print_type("action", chosen)


@action.command(epilog="Example: ifgen action find example_interfaces/action/Fibonacci")
@click.argument("type_name", metavar="TYPE", shell_complete=action_types)
@options.graph_options
@click.option("-c", "--count-actions", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
@takes(FindOptions)
def find(chosen: FindOptions) -> None:
    """Print the actions of a type."""
    from ifgen_tools.services import print_those_of_type

    print_those_of_type("action", chosen)


@action.command(epilog="Example: ifgen action info /walk -t")
@click.argument("name", metavar="ACTION", shell_complete=completion.actions)
@options.graph_options
@click.option("-t", "--show-types", is_flag=True, help="The types as well.")
@click.option("-c", "--count", is_flag=True, help="Only how many clients and servers there are.")
@options.json_option
@takes(NameOptions)
def info(chosen: NameOptions) -> None:
    """Print the nodes that serve an action, and those that send goals to it."""
    from ifgen_tools.services import action_info

    action_info(chosen)


@action.command(
    "send_goal",
    epilog="Example: ifgen action send_goal /count example_interfaces/action/Fibonacci '{order: 3}' -f",
)
@click.argument("name", metavar="ACTION", shell_complete=completion.actions)
@click.argument("type_name", metavar="TYPE", shell_complete=action_types)
@click.argument("values", metavar="[GOAL]", required=False)
@click.option("--stdin", "from_stdin", is_flag=True, help="Read the goal from stdin.")
@click.option("-f", "--feedback", is_flag=True, help="Print feedback as well.")
@options.transport_option
@options.json_option
@takes(CallOptions)
def send_goal(chosen: CallOptions) -> int:
    """Send a goal to an action, and print the result. Ctrl-C cancels the goal.

    GOAL is YAML. Fields that are not in it keep their default values; `auto` for a header and `now` for a
    time stand for the time of sending. TYPE need not be installed if the server describes it.
    """
    from ifgen_tools.action.send_goal import send_goal

    return send_goal(chosen)
