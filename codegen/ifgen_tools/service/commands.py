"""The verbs of `ifgen service`."""

from __future__ import annotations

from dataclasses import dataclass

import click
from ifgen.command_kit import options
from ifgen.command_kit.completion import service_types
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.texts.style import Style, style_options
from ifgen_tools.verbs import CallOptions, FindOptions, ListOptions, NameOptions, SessionOptions, takes

# Late imports: each verb loads what it needs.


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoOptions(SessionOptions):
    """The options of `service echo`."""

    name: str
    type_name: str | None
    style: Style
    csv: bool = False


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
@takes(ListOptions)
def list_(chosen: ListOptions) -> None:
    """Print the names of all services."""
    from ifgen_tools.services import print_list

    print_list("service", chosen)


@service.command("type", epilog="Example: ifgen service type /talker/get_parameters")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@options.graph_options
@options.use_sim_time_option
@options.json_option
@takes(NameOptions)
def type_(chosen: NameOptions) -> None:
    """Print the type of a service."""
    from ifgen_tools.services import print_type

    print_type("service", chosen)


@service.command(epilog="Example: ifgen service find rcl_interfaces/srv/GetParameters")
@click.argument("type_name", metavar="TYPE", shell_complete=service_types)
@options.graph_options
@options.use_sim_time_option
@_hidden
@click.option("-c", "--count-services", "--count", "count", is_flag=True, help="Only how many there are.")
@options.json_option
@takes(FindOptions)
def find(chosen: FindOptions) -> None:
    """Print the services of a type."""
    from ifgen_tools.services import print_those_of_type

    print_those_of_type("service", chosen)


@service.command(epilog="Example: ifgen service info /talker/get_parameters")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.option("-v", "--verbose", is_flag=True, help="The nodes that serve and call it as well.")
@options.graph_options
@options.use_sim_time_option
@options.json_option
@takes(NameOptions)
def info(chosen: NameOptions) -> None:
    """Print the type of a service, and how many nodes call and serve it."""
    from ifgen_tools.services import service_info

    service_info(chosen)


@service.command(epilog='Example: ifgen service call /add example_interfaces/srv/AddTwoInts "{a: 1, b: 2}"')
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.argument("type_name", metavar="TYPE", shell_complete=service_types)
@click.argument("values", metavar="[VALUES]", required=False)
@click.option("--stdin", "from_stdin", is_flag=True, help="Read the values from stdin.")
@click.option(
    "-r", "--rate", metavar="HZ", type=click.FloatRange(min=0, min_open=True), help="Call again at this rate."
)
@options.transport_option
@options.json_option
@takes(CallOptions)
def call(chosen: CallOptions) -> None:
    """Call a service, and print the response.

    VALUES is YAML. Fields that are not in it keep their default values; `auto` for a header and `now` for a
    time stand for the time of the call. TYPE need not be installed if the server describes it.
    """
    from ifgen_tools.service.call import call

    call(chosen)


@service.command(epilog="Example: ifgen service echo /add --flow-style")
@click.argument("name", metavar="SERVICE", shell_complete=completion.services)
@click.argument("type_name", metavar="[TYPE]", required=False, shell_complete=service_types)
@click.option("--csv", is_flag=True, help="All values with commas between them.")
@style_options
@options.transport_option
@options.json_option
@takes(EchoOptions)
def echo(chosen: EchoOptions) -> None:
    """Print the requests and responses of a service as they are sent and received.

    Who serves or calls it says so while introspection is on: `configure_introspection(...)` of its server or
    client in rclpy. There are no values in the events while the state is METADATA.
    """
    from ifgen_tools.service.call import echo

    echo(chosen)
