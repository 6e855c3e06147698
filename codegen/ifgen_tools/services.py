"""`list`, `type`, `find` and `info` of `ifgen service` and of `ifgen action`."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING, Literal, TypeAlias

from ifgen.command_kit.tool import Absent, did_you_mean
from ifgen.nodl.model import Category

from ifgen_tools.ros_graph import Named, View, actions, services
from ifgen_tools.session import open_session
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions

if TYPE_CHECKING:
    from rclpy.node import Node

Kind: TypeAlias = Literal["service", "action"]


def print_list(kind: Kind, chosen: ListOptions) -> None:
    """Print the services or the actions that there are now."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        entries = _all(kind, session.node, chosen.include_hidden)
    _print(entries, show_types=chosen.show_types, count=chosen.count, as_json=chosen.as_json)


def print_type(kind: Kind, chosen: NameOptions) -> None:
    """Print the type of one, or the types. Raises ToolError if there is none of this name."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        types = pick(kind, session.node, chosen.name).types
    print(json.dumps(types) if chosen.as_json else "\n".join(types))


def print_those_of_type(kind: Kind, chosen: FindOptions) -> None:
    """Print those of a type, `pkg/srv/Name` or for short `pkg/Name`: nothing if there is none."""
    package, _, name = chosen.type_name.partition("/")
    folder = "srv" if kind == "service" else "action"
    full_type = chosen.type_name if "/" in name else f"{package}/{folder}/{name}"
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        entries = _all(kind, session.node, chosen.include_hidden)
    _print([e for e in entries if full_type in e.types], count=chosen.count, as_json=chosen.as_json)


def service_info(chosen: NameOptions) -> None:
    """Print the type and the numbers of clients and servers. Raises ToolError if there is no such service."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        node = session.node
        service = pick("service", node, chosen.name)
        clients, servers = node.count_clients(service.name), node.count_services(service.name)
        view = session.graph()
    calling, serving = (
        [owner.name for owner in _owners(view, service.name, category)]
        for category in (Category.SERVICE_CLIENT, Category.SERVICE_SERVER)
    )
    if chosen.as_json:
        counts = {"clients": clients, "servers": servers, "client_nodes": calling, "server_nodes": serving}
        print(json.dumps({"name": service.name, "types": service.types, **counts}, indent=2))
        return
    print(f"Type: {service.types[0] if len(service.types) == 1 else service.types}")
    for what, number, nodes in (("Clients", clients, calling), ("Services", servers, serving)):
        print(f"{what} count: {number}")
        for name in nodes if chosen.verbose else []:
            print(f"    {name}")


def action_info(chosen: NameOptions) -> None:
    """Print who serves an action, and who has a client of it. Raises ToolError if there is no such action."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        name = pick("action", session.node, chosen.name).name
        view = session.graph()
    clients = _owners(view, name, Category.ACTION_CLIENT)
    servers = _owners(view, name, Category.ACTION_SERVER)
    if chosen.as_json:
        lists = {"clients": list(map(asdict, clients)), "servers": list(map(asdict, servers))}
        print(json.dumps({"name": name, **lists}, indent=2))
        return
    print(f"Action: {name}")
    for what, nodes in (("clients", clients), ("servers", servers)):
        print(f"Action {what}: {len(nodes)}")
        for node in [] if chosen.count else nodes:
            print(f"    {_line(node, chosen.show_types)}")


def pick(kind: Kind, node: Node, name: str) -> Named:
    """The one of this name, which may lack the `/` in front. Raises ToolError that names near ones."""
    by_name = {entry.name: entry for entry in _all(kind, node, include_hidden=True)}
    full = name if name.startswith("/") else f"/{name}"
    if full not in by_name:
        near = did_you_mean(full, sorted(by_name))
        raise Absent(f"there is no {kind} {full!r}", near or f"see `ifgen {kind} list`")
    return by_name[full]


def _all(kind: Kind, node: Node, include_hidden: bool) -> list[Named]:
    return services(node, include_hidden) if kind == "service" else actions(node)


def _owners(view: View, name: str, category: Category) -> list[Named]:
    """The nodes that have an endpoint of this kind, each once, with the types there."""
    types: dict[str, list[str]] = {}
    for end in view.ends(name, category):
        types.setdefault(end.node, []).append(end.type_name)
    return [Named(node, types_there) for node, types_there in types.items()]


def _print(
    entries: Iterable[Named], *, show_types: bool = False, count: bool = False, as_json: bool = False
) -> None:
    """Print a line for each, or only how many there are."""
    entries = list(entries)
    if count:
        print(len(entries))
    elif as_json:
        print(json.dumps(list(map(asdict, entries)), indent=2))
    else:
        print("".join(f"{_line(entry, show_types)}\n" for entry in entries), end="")


def _line(entry: Named, show_types: bool) -> str:
    return f"{entry.name} [{', '.join(entry.types)}]" if show_types else entry.name
