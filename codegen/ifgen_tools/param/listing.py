"""`ifgen param list`."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Sequence
from typing import Any

import click

from ifgen_tools.errors import ToolError
from ifgen_tools.graph.lookup import find_node
from ifgen_tools.graph.reading import node_names
from ifgen_tools.param.remote import TYPES, RemoteParameters
from ifgen_tools.session import Session, TransportChoice, open_session


def list_parameters(
    *,
    node: str | None = None,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = False,
    param_prefixes: Sequence[str] = (),
    with_types: bool = False,
    pattern: str | None = None,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print the names of the parameters of a node, or of all nodes that have services for them."""
    matches = _compiled(pattern)
    code, found = 0, dict[str, Any]()
    with open_session(transport, use_sim_time=use_sim_time) as session:
        if node is None:
            session.discover(spin_time)
            nodes = _nodes_with_parameters(session, include_hidden)
        else:
            nodes = [find_node(session, node, spin_time)]
        for name in nodes:
            try:
                remote = RemoteParameters(session, name, patience)
                names = [each for each in remote.names(param_prefixes) if matches.match(each)]
                types = remote.types(names) if with_types and names else {}
            except ToolError as error:
                if node is not None:
                    raise
                code = 1  # the others are shown nevertheless
                print(f"error: {error.message}", file=sys.stderr)
                continue
            found[name] = (
                {each: TYPES[types[each]] for each in names if each in types} if with_types else names
            )
            if not as_json:
                _print(name if node is None else None, found[name])
    if as_json:
        print(json.dumps(found, indent=2))
    return code


def _compiled(pattern: str | None) -> re.Pattern[str]:
    try:
        return re.compile(pattern or "")
    except re.error as error:
        raise click.UsageError(f"--filter {pattern!r} is no regular expression: {error}") from None


def _nodes_with_parameters(session: Session, include_hidden: bool) -> list[str]:
    services = {name for name, _ in session.node.get_service_names_and_types()}
    return [
        name for name in node_names(session.node, include_hidden) if f"{name}/list_parameters" in services
    ]


def _print(heading: str | None, found: dict[str, str] | list[str]) -> None:
    if heading is not None and found:
        print(f"{heading}:")
    for name in found:
        print(f"  {name} (type: {found[name]})" if isinstance(found, dict) else f"  {name}")
