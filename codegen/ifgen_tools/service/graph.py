"""`ifgen service list`, `type`, `find` and `info`: what the graph tells."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ifgen.nodl.model import Category

from ifgen_tools.graph.lookup import of_type, pick, print_named
from ifgen_tools.graph.reading import Named, View, services
from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.session import TransportChoice


def list_services(
    *,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    include_hidden: bool = False,
    show_types: bool = False,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print the services that there are now."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = services(session.node, include_hidden)
    print_named(found, show_types=show_types, count=count, as_json=as_json)


def print_type(
    *,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    as_json: bool = False,
) -> None:
    """Print the type of a service, or the types. Raises ToolError if there is no such service."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = pick_service(session.node, name)
    print(json.dumps(found.types) if as_json else "\n".join(found.types))


def find_services(
    *,
    type_name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    include_hidden: bool = False,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print the services of a type: nothing if there is none."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = services(session.node, include_hidden)
    print_named(of_type(found, type_name, "srv"), count=count, as_json=as_json)


def service_info(
    *,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    verbose: bool = False,
    as_json: bool = False,
) -> None:
    """Print the type and the numbers of clients and servers. Raises ToolError if there is no such service."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        node = session.node
        found = pick_service(node, name)
        clients, servers = node.count_clients(found.name), node.count_services(found.name)
        view = session.graph()
    calling = _nodes(view, found.name, Category.SERVICE_CLIENT)
    serving = _nodes(view, found.name, Category.SERVICE_SERVER)
    if as_json:
        counts = {"clients": clients, "servers": servers, "client_nodes": calling, "server_nodes": serving}
        print(json.dumps({"name": found.name, "types": found.types, **counts}, indent=2))
        return
    print(f"Type: {found.types[0] if len(found.types) == 1 else found.types}")
    for what, number, nodes in (("Clients", clients, calling), ("Services", servers, serving)):
        print(f"{what} count: {number}")
        for each in nodes if verbose else []:
            print(f"    {each}")


def pick_service(node: Node, name: str) -> Named:
    """The service of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(services(node), name, "service")


def _nodes(view: View, service: str, category: Category) -> list[str]:
    """The nodes that have a service, or clients of it, each once."""
    return list(dict.fromkeys(end.node for end in view.ends(service, category)))
