"""Nodes by the names that a user writes."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from ifgen.command_kit.tool import Absent, did_you_mean

from ifgen_tools import discovery
from ifgen_tools.graph.reading import node_names

if TYPE_CHECKING:
    from ifgen_tools.session import Session

_PATIENCE: Final = 5.0
"""Seconds that a named node may take to be discovered."""


def find_node(session: Session, name: str, spin_time: float | None = None) -> str:
    """The full name of a node that the user named, once it is there.

    A hidden one, too: a user who names it wants it. If several have the name, it says so on stderr.
    Raises ToolError if it is not there after `spin_time` [s].
    """
    wanted = name if name.startswith("/") else f"/{name}"
    domain = session.context.get_domain_id()

    def is_there() -> bool:
        return wanted in node_names(session.node, True)

    def is_known() -> bool:
        return is_there() or (session.transport == "local" and discovery.knows_everybody(domain))

    session.wait_for(is_known, _PATIENCE if spin_time is None else spin_time)
    if is_there():
        if (number := node_names(session.node, True).count(wanted)) > 1:
            print(
                f"warning: {number} nodes are called {wanted}: what they have is shown together, or that of "
                "one of them only",
                file=sys.stderr,
            )
        return wanted
    known = node_names(session.node)
    advice = did_you_mean(wanted, known) or (
        "see `ifgen node list`" if known else "no node is running, or none that this process can see"
    )
    raise Absent(f"there is no node {wanted!r}", advice)
