"""The verbs of `ifgen param`, which read their options and leave the work to a module each."""

from __future__ import annotations

import re
from functools import wraps
from typing import Any, Final

import click
from ifgen.command_kit import options
from ifgen.command_kit.options import Command
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.param.options import (
    DescribeOptions,
    GetOptions,
    LoadOptions,
    ParamListOptions,
    SetOptions,
)
from ifgen_tools.verbs import ManyCommand, ManyOption, NodeOptions, takes

# Late imports: each verb loads what it needs.

_NUMBER: Final = re.compile(r"-\.?(\d|inf)")


@click.group(cls=ToolGroup)
def param() -> None:
    """Look at the parameters of running nodes, and set them."""


def _node_options(command: Command) -> Command:
    """The options of every verb, as in ROS."""
    for option in (
        options.json_option,
        options.hidden_nodes_option,
        options.use_sim_time_option,
        options.graph_options,
    ):
        command = option(command)
    return command


def _timeout_option(command: Command) -> Command:
    """`--timeout SECONDS` of ROS, which is `spin_time` where that is not given."""

    @wraps(command)
    def run(timeout: float | None, spin_time: float | None, **values: Any) -> Any:
        return command(spin_time=timeout if spin_time is None else spin_time, **values)

    return click.option(
        "--timeout",
        type=click.FloatRange(min=0),
        metavar="SECONDS",
        help="How long to wait for the node. The default is 5 s, less if it cannot be there.",
    )(run)


def _patience_option(command: Command) -> Command:
    return click.option(
        "--service-timeout",
        "patience",
        type=click.FloatRange(min=0),
        metavar="SECONDS",
        help="How long to wait for the node's answer. The default is until it comes.",
    )(command)


@param.command("list", cls=ManyCommand, epilog="Example: `ifgen param list /talker --param-type`")
@click.argument("node", required=False, shell_complete=completion.nodes)
@_node_options
@click.option(
    "--param-prefixes", cls=ManyOption, metavar="PREFIX...", help="Only parameters below these prefixes."
)
@click.option("--param-type", "with_types", is_flag=True, help="The types as well.")
@click.option("--filter", "pattern", metavar="REGEX", help="Only parameters whose names match.")
@_patience_option
@takes(ParamListOptions)
def list_(chosen: ParamListOptions) -> int:
    """Print the parameters of a node, or of all nodes."""
    from ifgen_tools.param.show import list_parameters

    return list_parameters(chosen)


@param.command(epilog="Example: `ifgen param get /talker use_sim_time`")
@click.argument("node", shell_complete=completion.nodes)
@click.argument("name", shell_complete=completion.parameters)
@_node_options
@click.option("--hide-type", is_flag=True, help="Only the value.")
@_patience_option
@_timeout_option
@takes(GetOptions)
def get(chosen: GetOptions) -> int:
    """Print the value of a parameter."""
    from ifgen_tools.param.show import get_parameter

    return get_parameter(chosen)


@param.command(
    "set",
    context_settings={"ignore_unknown_options": True},  # so that -1 is a value
    epilog="Example: `ifgen param set /talker use_sim_time true`",
)
@click.argument("node", shell_complete=completion.nodes)
@click.argument(
    "pairs",
    nargs=-1,
    required=True,
    metavar="NAME VALUE [NAME VALUE]...",
    shell_complete=completion.parameters,
)
@_node_options
@click.option("--atomic", is_flag=True, help="All of them or none.")
@_patience_option
@_timeout_option
@takes(SetOptions)
def set_(chosen: SetOptions) -> int:
    """Set parameters of a node. Values are YAML: 0.5, true, text, [1, 2]."""
    from ifgen_tools.param.set import set_parameters

    context = click.get_current_context()
    for word in chosen.pairs:
        if word.startswith("-") and len(word) > 1 and not _NUMBER.match(word):
            raise click.NoSuchOption(word.partition("=")[0], ctx=context)
    if len(chosen.pairs) % 2:
        raise click.UsageError("every name needs a value after it: NAME VALUE [NAME VALUE]...", context)
    return set_parameters(chosen)


@param.command(epilog="Example: `ifgen param delete /talker speed`")
@click.argument("node", shell_complete=completion.nodes)
@click.argument("name", shell_complete=completion.parameters)
@_node_options
@_patience_option
@_timeout_option
@takes(GetOptions)
def delete(chosen: GetOptions) -> int:
    """Delete a parameter that the node allows to be deleted."""
    from ifgen_tools.param.set import delete_parameter

    return delete_parameter(chosen)


@param.command(epilog="Example: `ifgen param describe /talker use_sim_time`")
@click.argument("node", shell_complete=completion.nodes)
@click.argument("names", nargs=-1, required=True, metavar="NAME...", shell_complete=completion.parameters)
@_node_options
@_patience_option
@_timeout_option
@takes(DescribeOptions)
def describe(chosen: DescribeOptions) -> int:
    """Print the types, descriptions and limits of parameters."""
    from ifgen_tools.param.show import describe_parameters

    return describe_parameters(chosen)


@param.command(epilog="Example: `ifgen param dump /talker > talker.yaml`")
@click.argument("node", shell_complete=completion.nodes)
@_node_options
@_patience_option
@_timeout_option
@takes(NodeOptions)
def dump(chosen: NodeOptions) -> int:
    """Print all parameters of a node as a YAML file, for `ifgen param load` and --params-file."""
    from ifgen_tools.param.show import dump_parameters

    return dump_parameters(chosen)


@param.command(epilog="Example: `ifgen param load /talker talker.yaml`")
@click.argument("node", shell_complete=completion.nodes)
@click.argument("file", type=click.Path())
@_node_options
@click.option("--no-use-wildcard", is_flag=True, help="Leave out the parameters of `/**` in the file.")
@_patience_option
@_timeout_option
@takes(LoadOptions)
def load(chosen: LoadOptions) -> int:
    """Set the parameters of a node from a YAML file."""
    from ifgen_tools.param.set import load_parameters

    return load_parameters(chosen)
