"""Tells a user who looks where nobody is about nodes on the other transport, or in another domain."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Final

from ifgen_runtime.domains import neighbours

from ifgen_tools.ros_graph import node_names

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

_FIRST: Final = 0.3
"""Seconds after which a tool that waits has a look whether it waits in the wrong place."""

_EVERY: Final = 3.0
"""Seconds between this look and the others. By then, the nodes of other machines are discovered."""


class Lookout:
    """Says it once, in one line on stderr; never again once a visible node has been seen here.

    `transport` is that of `node`, which does not count. Assign to `say` to have the line elsewhere.
    """

    def __init__(self, transport: str, node: Node) -> None:
        self.say: Callable[[str], object] = _say
        self._transport = transport
        self._node = node
        self._due = time.monotonic() + _FIRST
        self._is_late = False
        self._has_met = False
        self._has_told = False

    def look(self) -> None:
        """Say it if a tool has waited for a while, and nobody is here. Costs nothing until then."""
        if self._has_told or time.monotonic() < self._due or self._meets():
            return
        if self._is_certain() or (self._is_late and not self._is_expected()):
            self._tell(neighbours.elsewhere(self._transport, self._domain))
        self._is_late = True
        self._due = time.monotonic() + _EVERY

    def look_around(self) -> None:
        """Say it if nobody is here, now that the graph has been discovered."""
        if not (self._has_told or self._meets()):
            self._tell(neighbours.elsewhere(self._transport, self._domain))

    def look_back(self) -> None:
        """Say it at the end of a tool that has not waited for anybody, if it is certain."""
        if not (self._has_told or self._meets()) and self._is_certain():
            self._tell(neighbours.elsewhere(self._transport, self._domain))

    def tell_of_other(self) -> None:
        """Say who is on the other transport, whoever is on this one: what the user wants is not."""
        if not self._has_told:
            self._tell(neighbours.on_other(self._transport, self._domain))

    def advice(self) -> str:
        """The same as help for an error about something that is not here; empty if it has been said."""
        if self._has_told:
            return ""
        find = neighbours.on_other if self._meets() else neighbours.elsewhere
        return find(self._transport, self._domain)

    @property
    def _domain(self) -> int:
        return self._node.context.get_domain_id()

    def _is_certain(self) -> bool:
        return neighbours.is_elsewhere_only(self._transport, self._domain)

    def _is_expected(self) -> bool:
        """Whether somebody runs on this transport who will be discovered."""
        return neighbours.is_here(self._transport, self._domain)

    def _meets(self) -> bool:
        """Whether somebody has ever been here."""
        self._has_met = self._has_met or self._has_company()
        return self._has_met

    def _has_company(self) -> bool:
        return bool(node_names(self._node))

    def _tell(self, text: str) -> None:
        if text:
            self._has_told = True
            self.say(text)


def _say(text: str) -> None:
    print(f"note: {text}", file=sys.stderr, flush=True)
