"""`ifgen node list`."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

from ifgen_tools.nodes import node_names
from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from ifgen_tools.session import TransportChoice


def list_nodes(
    *,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    use_sim_time: bool = False,
    include_hidden: bool = False,
    count: bool = False,
    as_json: bool = False,
) -> None:
    """Print the nodes that run now; on stderr, if two nodes have one name."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        session.discover(spin_time)
        found = node_names(session.node, include_hidden)
    if count:
        print(len(found))
    elif as_json:
        print(json.dumps(found, indent=2))
    else:
        for name in found:
            print(name)
    twice = sorted({name for name in found if found.count(name) > 1})
    if twice:
        print(f"warning: more than one node is called {', '.join(twice)}", file=sys.stderr)
