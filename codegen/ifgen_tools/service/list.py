"""`ifgen service list`, `type`, `find` and `info`: the services in the graph."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ifgen_tools.named import Named, named, of_type, pick, print_named
from ifgen_tools.names import full_name, is_hidden
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
        calling = _nodes_with(found.name, node, node.get_client_names_and_types_by_node)
        serving = _nodes_with(found.name, node, node.get_service_names_and_types_by_node)
    if chosen.as_json:
        counts = {"clients": clients, "servers": servers, "client_nodes": calling, "server_nodes": serving}
        print(json.dumps({"name": found.name, "types": found.types, **counts}, indent=2))
        return
    print(f"Type: {found.types[0] if len(found.types) == 1 else found.types}")
    for what, number, nodes in (("Clients", clients, calling), ("Services", servers, serving)):
        print(f"{what} count: {number}")
        for each in nodes if chosen.verbose else []:
            print(f"    {each}")


def services(node: Node, include_hidden: bool = True) -> list[Named]:
    """The services that a node sees, sorted by name, without its own."""
    own = f"{full_name(node.get_name(), node.get_namespace())}/"
    found = named(node.get_service_names_and_types())
    return [s for s in found if not s.name.startswith(own) and (include_hidden or not is_hidden(s.name))]


def pick_service(node: Node, name: str) -> Named:
    """The service of this name, which may lack the `/` in front. Raises ToolError."""
    return pick(services(node), name, "service")


def _nodes_with(service: str, node: Node, ask: Callable[[str, str], Any]) -> list[str]:
    """The nodes whose services or clients, as `ask` tells, include this one."""
    from rclpy.node import NodeNameNonExistentError  # found once the transport has been chosen

    found: list[str] = []
    for name, namespace in node.get_node_names_and_namespaces():
        try:
            known = ask(name, namespace)
        except NodeNameNonExistentError:  # has gone since
            continue
        if any(service == each for each, _ in known):
            found.append(full_name(name, namespace))
    return sorted(set(found))
