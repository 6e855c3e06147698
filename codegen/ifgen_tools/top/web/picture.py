"""The graph of nodes as boxes and lines: which, and where."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final

from ifgen_tools.graph.layout import Edge, layout
from ifgen_tools.ros_graph import FRAMEWORK_SERVICES, FRAMEWORK_TOPICS
from ifgen_tools.top.screen.tables import shortened
from ifgen_tools.top.snapshot import Snapshot

_CHARACTER: Final = 7.2  # [px]
_PADDING: Final = 22.0  # [px]
_HEIGHT: Final = 40.0  # [px]: a name and a line below it
_SHORTEST: Final = 14  # characters, of the line below
_LONGEST: Final = 28  # characters of a name; more is cut in the middle
_CROWD: Final = 10
"""The number of ends from which something that all nodes share would hide the rest: a box without lines."""

Part = tuple[str, str, tuple[str, ...], tuple[str, ...]]
"""Something that nodes talk over: kind, name, sources, targets."""

Structure = tuple[tuple[str, ...], tuple[Part, ...]]
"""Nodes, and what they talk over."""


def structure(snapshot: Snapshot) -> Structure:
    """The parts to draw: nodes, topics, services and actions without those that every node has."""
    parts: list[Part] = [
        ("topic", each.name, _once(each.publishers), _once(each.subscriptions))
        for each in snapshot.topics
        if each.name not in FRAMEWORK_TOPICS
    ]
    parts += [
        ("service", each.name, each.clients, each.servers)
        for each in snapshot.services
        if each.clients or each.name.rpartition("/")[2] not in FRAMEWORK_SERVICES
    ]
    parts += [("action", each.name, each.clients, each.servers) for each in snapshot.actions]
    return tuple(each.name for each in snapshot.nodes), tuple(parts)


def pictures(found: Structure) -> dict[str, Any]:
    """A picture for each choice: with services or not, and with topics that have one side only or not.

    They are called `00` (neither), `01` (the latter), `10` and `11`.
    """
    nodes, parts = found
    return {
        f"{services:d}{leaves:d}": picture(
            (nodes, tuple(part for part in parts if _is_drawn(part, services=services, leaves=leaves)))
        )
        for services in (False, True)
        for leaves in (False, True)
    }


def picture(found: Structure) -> dict[str, Any]:
    """Boxes with their centres and sizes [px], and which of them lines connect. Ids are `kind name`."""
    nodes, parts = found
    names = {f"node {name}": name for name in nodes} | {f"{kind} {name}": name for kind, name, _, _ in parts}
    labels = {key: shortened(name, _LONGEST) for key, name in names.items()}
    known = set(nodes)
    edges = list(dict.fromkeys(edge for part in parts for edge in _edges(part, known)))
    sizes = {
        key: (max(len(label), _SHORTEST) * _CHARACTER + _PADDING, _HEIGHT) for key, label in labels.items()
    }
    placed = layout(sizes, edges, distances(list(labels), edges))
    boxes = [
        {
            "id": key,
            "kind": key.partition(" ")[0],
            "name": names[key],
            "label": label,
            "x": round(placed.centres[key][0], 1),
            "y": round(placed.centres[key][1], 1),
            "width": round(sizes[key][0], 1),
            "height": _HEIGHT,
        }
        for key, label in labels.items()
    ]
    return {
        "boxes": boxes,
        "lines": [{"from": source, "to": target} for source, target in edges],
        "width": round(placed.width, 1),
        "height": round(placed.height, 1),
    }


def distances(boxes: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """How far each box is from a source of its part of the graph: its column.

    Nodes only have topics, services and actions as neighbours, so each line joins neighbouring columns: the
    picture is as narrow as it can be, and no line passes behind a box. What sends most and receives least is
    the source. Lines that point back to the left are the price.
    """
    neighbours: defaultdict[str, set[str]] = defaultdict(set)
    surplus: Counter[str] = Counter()
    for source, target in edges:
        neighbours[source].add(target)
        neighbours[target].add(source)
        surplus[source] += 1
        surplus[target] -= 1
    found: dict[str, int] = {}
    roots = sorted(boxes, key=lambda box: (not box.startswith("node "), -surplus[box], box))
    for root in roots:
        if root in found:
            continue
        found[root] = 0
        waiting = deque([root])
        while waiting:
            box = waiting.popleft()
            for other in sorted(neighbours[box] - found.keys()):
                found[other] = found[box] + 1
                waiting.append(other)
    return {box: found[box] for box in boxes}


def _is_drawn(part: Part, *, services: bool, leaves: bool) -> bool:
    kind, _, sources, targets = part
    return services if kind == "service" else leaves or kind != "topic" or bool(sources and targets)


def _edges(part: Part, known: set[str]) -> Iterator[Edge]:
    kind, name, sources, targets = part
    if len(sources) + len(targets) >= _CROWD:
        return
    key = f"{kind} {name}"
    yield from ((f"node {node}", key) for node in sources if node in known)
    yield from ((key, f"node {node}") for node in targets if node in known)


def _once(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))
