"""A system from nodes that run, on either transport, and the rules about it."""

from __future__ import annotations

from ifgen.diagnostics import Diagnostic

from ifgen_tools.ros_graph import View
from ifgen_tools.system.model import Endpoint, NodeInstance, System
from ifgen_tools.system.rules import check_running


def findings(view: View) -> list[Diagnostic]:
    """Everything that is wrong with the connections of the nodes in a graph."""
    return check_running(of_graph(view))


def of_graph(view: View) -> System:
    """The nodes of a graph with the endpoints that their authors wrote."""
    authors = view.of_authors()
    nodes = []
    for name in authors.nodes:
        ends = tuple(
            Endpoint(
                node=name,
                category=end.category,
                written=end.name,
                expanded=end.name,
                name=end.name,
                type_name=end.type_name,
                type_hash=end.type_hash or "",
                qos=end.qos,
            )
            for end in authors.endpoints
            if end.node == name
        )
        nodes.append(NodeInstance(name, "", "", "running", endpoints=ends))
    return System(tuple(nodes))
