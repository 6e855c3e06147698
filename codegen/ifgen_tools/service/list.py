"""`ifgen service list`, `type`, `find` and `info`: the services in the graph."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ifgen.nodl.model import Category

from ifgen_tools.graph.lookup import of_type, pick, print_named
from ifgen_tools.graph.reading import Named, View, services
from ifgen_tools.session import open_session
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions

if TYPE_CHECKING:
    from rclpy.node import Node


def list_services(chosen: ListOptions) -> None:
    """Print the services that there are now."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        found = services(session.node, chosen.include_hidden)
    print_named(found, show_types=chosen.show_types, count=chosen.count, as_json=chosen.as_json)


def print_type(chosen: NameOptions) -> None:
    """Print the type of a service, or the types. Raises ToolError if there is no such service."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        found = pick_service(session.node, chosen.name)
    print(json.dumps(found.types) if chosen.as_json else "\n".join(found.types))


def find_services(chosen: FindOptions) -> None:
    """Print the services of a type: nothing if there is none."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        found = services(session.node, chosen.include_hidden)
    print_named(of_type(found, chosen.type_name, "srv"), count=chosen.count, as_json=chosen.as_json)


def service_info(chosen: NameOptions) -> None:
    """Print the type and the numbers of clients and servers. Raises ToolError if there is no such service."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        node = session.node
        found = pick_service(node, chosen.name)
        clients, servers = node.count_clients(found.name), node.count_services(found.name)
        view = session.graph()
    calling = _nodes(view, found.name, Category.SERVICE_CLIENT)
    serving = _nodes(view, found.name, Category.SERVICE_SERVER)
    if chosen.as_json:
        counts = {"clients": clients, "servers": servers, "client_nodes": calling, "server_nodes": serving}
        print(json.dumps({"name": found.name, "types": found.types, **counts}, indent=2))
        return
    print(f"Type: {found.types[0] if len(found.types) == 1 else found.types}")
    for what, number, nodes in (("Clients", clients, calling), ("Services", servers, serving)):
        print(f"{what} count: {number}")
        for each in nodes if chosen.verbose else []:
            print(f"    {each}")


def pick_service(node: Node, name: str) -> Named:
    """The service of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(services(node), name, "service")


def _nodes(view: View, service: str, category: Category) -> list[str]:
    """The nodes that have a service, or clients of it, each once."""
    return list(dict.fromkeys(end.node for end in view.ends(service, category)))
