"""Names in the graph: which are hidden, and how a node is called in full."""

from __future__ import annotations


def is_hidden(name: str) -> bool:
    """Whether a part of the name of a topic, a service or a node begins with `_`."""
    return any(part.startswith("_") for part in name.split("/"))


def full_name(name: str, namespace: str) -> str:
    """The full name of a node: `/robot/arm` of `arm` in `/robot`."""
    return f"{namespace.rstrip('/')}/{name}"
