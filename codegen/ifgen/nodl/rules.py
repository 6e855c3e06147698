"""What can be wrong with a whole node, and with the nodes of a package together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ifgen.diagnostics import Diagnostic
from ifgen.nodl.model import NodeDescription


def check_node(node: NodeDescription) -> Iterator[Diagnostic]:
    """What is wrong with one node."""
    yield from ()


def check_package(nodes: Sequence[NodeDescription]) -> Iterator[Diagnostic]:
    """What is wrong with the nodes of a package together."""
    yield from ()
