"""The verbs of `ifgen service`."""

from __future__ import annotations

from typing import Any

import click

from ifgen_tools import completion, options
from ifgen_tools.group import ToolGroup

# Late imports: each verb loads what it needs.


def _hidden(command: options.Command) -> options.Command:
    return click.option(
        "--include-hidden-services", "include_hidden", is_flag=True, help="Hidden services as well."
    )(command)


@click.group(cls=ToolGroup)
@_hidden
@click.pass_context
def service(context: click.Context, include_hidden: bool) -> None:
    """Look at services, call them, and listen to calls."""
    if include_hidden:  # ROS has the option before the verb, too
        context.default_map = {verb: {"include_hidden": True} for verb in service.commands}


@service.command("list", epilog="Example: ifgen service list -t")
@options.graph_options
@options.use_sim_time_option
@_hidden
@click.option("-t", "--show-types", is_flag=True, help="The types as well.")
@click.option("-c", "--count-services", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
def list_(**chosen: Any) -> None:
    """Print the names of all services."""
    from ifgen_tools.service import graph

    graph.list_services(**chosen)


@service.command("type", epilog="Example: ifgen service type /talker/get_parameters")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@options.graph_options
@options.use_sim_time_option
@options.json_option
def type_(**chosen: Any) -> None:
    """Print the type of a service."""
    from ifgen_tools.service import graph

    graph.print_type(**chosen)


@service.command(epilog="Example: ifgen service find rcl_interfaces/srv/GetParameters")
@click.argument("type_name", metavar="TYPE", shell_complete=completion.service_types)
@options.graph_options
@options.use_sim_time_option
@_hidden
@click.option("-c", "--count-services", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
def find(**chosen: Any) -> None:
    """Print the services of a type."""
    from ifgen_tools.service import graph

    graph.find_services(**chosen)


@service.command(epilog="Example: ifgen service info /talker/get_parameters")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.option("-v", "--verbose", is_flag=True, help="The nodes that serve and call it as well.")
@options.graph_options
@options.use_sim_time_option
@options.json_option
def info(**chosen: Any) -> None:
    """Print the type of a service, and how many nodes call and serve it."""
    from ifgen_tools.service import graph

    graph.service_info(**chosen)


@service.command(epilog='Example: ifgen service call /add example_interfaces/srv/AddTwoInts "{a: 1, b: 2}"')
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.argument("type_name", metavar="TYPE", shell_complete=completion.service_types)
@click.argument("values", metavar="[VALUES]", required=False)
@click.option("--stdin", "from_stdin", is_flag=True, help="Read the values from stdin.")
@click.option(
    "-r", "--rate", metavar="HZ", type=click.FloatRange(min=0, min_open=True), help="Call again at this rate."
)
@options.transport_option
@options.json_option
def call(as_json: bool, **chosen: Any) -> None:
    """Call a service, and print the response.

    VALUES is YAML. Fields that are not in it keep their default values; `auto` for a header and `now` for a
    time stand for the time of the call. TYPE need not be installed if the server describes it.
    """
    from ifgen_tools.service.call import call

    call(in_json=as_json, **chosen)


@service.command(epilog="Example: ifgen service echo /add --flow-style")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.argument("type_name", metavar="[TYPE]", required=False, shell_complete=completion.service_types)
@click.option("--csv", "as_csv", is_flag=True, help="All values with commas between them.")
@click.option("-f", "--full-length", is_flag=True, help="Do not cut arrays and strings.")
@click.option(
    "-l",
    "--truncate-length",
    metavar="N",
    type=click.IntRange(min=0),
    default=128,
    help="Cut arrays and strings after this length. The default is 128.",
)
@click.option("--no-arr", is_flag=True, help="No arrays.")
@click.option("--no-str", is_flag=True, help="No strings.")
@click.option("--flow-style", is_flag=True, help="Lists in one line.")
@options.transport_option
@options.json_option
def echo(
    as_csv: bool,
    full_length: bool,
    truncate_length: int,
    no_arr: bool,
    no_str: bool,
    flow_style: bool,
    as_json: bool,
    **chosen: Any,
) -> None:
    """Print the requests and responses of a service as they are sent and received.

    Who serves or calls it says so while introspection is on: `configure_introspection(...)` of its server or
    client in rclpy. There are no values in the events while the state is METADATA.
    """
    from ifgen_tools.service.echo import echo
    from ifgen_tools.texts.formats import Style

    if as_csv and as_json:
        raise click.UsageError("--csv and --json exclude each other")
    style = Style(None if full_length else truncate_length, no_arr, no_str, flow_style)
    echo(form="csv" if as_csv else "json" if as_json else "yaml", style=style, **chosen)
