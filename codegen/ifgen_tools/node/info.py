"""`ifgen node info`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING, Any

from ifgen_tools.errors import ToolError
from ifgen_tools.named import Named
from ifgen_tools.names import is_hidden
from ifgen_tools.nodes import find_node
from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.session import TransportChoice

# Late imports: rclpy is found once the transport has been chosen.


def node_info(
    *,
    node_name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    include_hidden: bool = False,
    as_json: bool = False,
) -> None:
    """Print what a node has. Raises ToolError if there is no such node."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        wanted = find_node(session, node_name, spin_time)
        found = _all_of(session.node, wanted, include_hidden)
    if as_json:
        lists = {role.lower().replace(" ", "_"): [asdict(each) for each in of] for role, of in found.items()}
        print(json.dumps({"name": wanted, **lists}, indent=2))
        return
    print(wanted)
    for role, each in found.items():
        print(f"  {role}:")
        print("\n".join(f"    {has.name}: {', '.join(has.types)}" for has in each))


def _all_of(node: Node, wanted: str, include_hidden: bool) -> dict[str, list[Named]]:
    """The endpoints of a node, in the order in which they are printed."""
    import rclpy.action
    from rclpy.node import NodeNameNonExistentError

    questions: dict[str, Callable[[str, str], Any]] = {
        "Subscribers": node.get_subscriber_names_and_types_by_node,
        "Publishers": node.get_publisher_names_and_types_by_node,
        "Service Servers": node.get_service_names_and_types_by_node,
        "Service Clients": node.get_client_names_and_types_by_node,
        "Action Servers": partial(rclpy.action.get_action_server_names_and_types_by_node, node),
        "Action Clients": partial(rclpy.action.get_action_client_names_and_types_by_node, node),
    }
    namespace, _, name = wanted.rpartition("/")
    try:
        answers = {role: question(name, namespace or "/") for role, question in questions.items()}
    except NodeNameNonExistentError:
        raise ToolError(f"the node {wanted!r} has just gone") from None
    return {
        role: [Named(name, list(types)) for name, types in answer if include_hidden or not is_hidden(name)]
        for role, answer in answers.items()
    }
