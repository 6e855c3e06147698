"""`ifgen lifecycle nodes` and `get`."""

from __future__ import annotations

import json
import sys
from typing import Any

from ifgen.command_kit.tool import ToolError

from ifgen_tools.lifecycle.remote import RemoteLifecycle, find_lifecycle_node, lifecycle_nodes
from ifgen_tools.session import TransportChoice, open_session


def list_nodes(
    *,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = False,
    count_nodes: bool = False,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print the names of the lifecycle nodes."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = lifecycle_nodes(session, include_hidden)
    if count_nodes:
        print(len(found))
    elif as_json:
        print(json.dumps(found, indent=2))
    else:
        for name in found:
            print(name)
    return 0


def get_states(
    *,
    node: str | None = None,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = False,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print the state of a node, or of all lifecycle nodes."""
    code, found = 0, dict[str, Any]()
    with open_session(transport, use_sim_time=use_sim_time) as session:
        if node is None:
            session.discover(spin_time)
            nodes = lifecycle_nodes(session, include_hidden)
        else:
            nodes = [find_lifecycle_node(session, node, spin_time)]
        for name in nodes:
            try:
                state = RemoteLifecycle(session, name).state()
            except ToolError as error:
                if node is not None:
                    raise
                code = 1  # the others are shown nevertheless
                print(f"error: {error.message}", file=sys.stderr)
                continue
            found[name] = {"label": state.label, "id": state.id}
            if not as_json:
                print(f"{'' if node else f'{name}: '}{state.label} [{state.id}]")
    if as_json:
        print(json.dumps(found, indent=2))
    return code
