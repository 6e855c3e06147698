"""The contents of open pages: snapshots, the graph as boxes and lines, and messages as trees of JSON."""

from __future__ import annotations

import math
import time
from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.graph.layout import Edge, layout
from ifgen_tools.ros_graph import FRAMEWORK_SERVICES, FRAMEWORK_TOPICS
from ifgen_tools.top.screen.tables import shortened
from ifgen_tools.top.snapshot import Snapshot, as_json
from ifgen_tools.top.web.server import Server, Stream

if TYPE_CHECKING:
    from ifgen_tools.top.collector import Collector


_CHARACTER: Final = 7.2  # [px]
_PADDING: Final = 22.0  # [px]
_HEIGHT: Final = 40.0  # [px]: a name and a line below it
_SHORTEST: Final = 14  # characters, of the line below
_LONGEST_NAME: Final = 28  # characters of a name; more is cut in the middle
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
    labels = {key: shortened(name, _LONGEST_NAME) for key, name in names.items()}
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


_TURN: Final = 0.05  # [s] between two messages of an inspected topic
_IDLE: Final = 0.5  # [s] between two looks whether a page is open
_MOST_ITEMS: Final = 64
"""The number of elements that are shown of a sequence."""
_LONGEST: Final = 1000  # characters of a text
_MOST: Final = 3000
"""The number of values in a tree."""

Tree = dict[str, Any]


class Page:
    """The pages that are open, and what they have been sent."""

    def __init__(self, server: Server, collector: Collector) -> None:
        self._server = server
        self._collector = collector
        self._structure: Structure | None = None
        self._shown: dict[str, bytes] = {}  # the message of each topic that was sent last
        self._streams: tuple[Stream, ...] = ()

    def look(self) -> None:
        """Take a snapshot and send it, with a picture if the graph has changed."""
        self._want()
        snapshot = self._collector.step()
        found = structure(snapshot)
        if found != self._structure:
            self._structure = found
            self._server.show("picture", pictures(found))
        self._server.show("snapshot", as_json(snapshot))

    def send_messages(self) -> None:
        """Send the latest message of each topic that a page inspects."""
        from rclpy.serialization import deserialize_message  # of the chosen transport

        if self._server.streams() != self._streams:
            self._want()
            self._collector.listen()
        for topic in {stream.inspected for stream in self._streams}:
            tap = self._collector.tap(topic)
            if tap is None or tap.latest is None or tap.latest is self._shown.get(topic):
                continue
            self._shown[topic] = tap.latest
            try:
                fields: Any = tree(deserialize_message(tap.latest, tap.cls))
            except Exception as error:  # whatever somebody has sent
                fields = {"cannot be read": str(error)}
            self._server.show_message(topic, {"topic": topic, "at": time.time(), "fields": fields})

    def _want(self) -> None:
        """Want what the pages inspect and show; one that comes back gets the latest ones."""
        streams = self._server.streams()
        if streams != self._streams:
            self._streams = streams
            self._shown.clear()
        inspected = [stream.inspected for stream in streams if stream.inspected]
        self._collector.want([*inspected, *(topic for stream in streams for topic in stream.shown)])


def serve(collector: Collector, port: int, period: float) -> None:
    """Serve the page until Ctrl-C; nothing is asked or listened to while no page is open."""
    try:
        server = Server(port)
    except OSError as error:
        raise ToolError(
            f"port {port} of 127.0.0.1 cannot be used: {error.strerror or error}",
            "name another one with --port, or 0 for any",
        ) from None
    print(f"ifgen top: http://127.0.0.1:{server.port}/ (Ctrl-C ends it)", flush=True)
    page = Page(server, collector)
    try:
        while True:
            if not server.wait_for_pages(0):
                collector.close()
                while not server.wait_for_pages(_IDLE):
                    collector.spin(0)
            page.look()
            end = time.monotonic() + period
            while (left := end - time.monotonic()) > 0:
                page.send_messages()
                collector.spin(min(_TURN, left))
    finally:
        server.close()


def tree(message: Any) -> Tree:
    """The fields of a message by name. A sequence that is cut has `{"more": count}` as its last element."""
    return _Budget().message(message)


class _Budget:
    def __init__(self) -> None:
        self._left = _MOST

    def message(self, message: Any) -> Tree:
        names = type(message).get_fields_and_field_types()
        return {name: self._value(getattr(message, name)) for name in names}

    def _value(self, value: Any) -> Any:
        self._left -= 1
        if value is None or isinstance(value, bool | int):
            return _safe(value)
        if isinstance(value, float):
            return value if math.isfinite(value) else str(value)
        if isinstance(value, str):
            return value if len(value) <= _LONGEST else f"{value[:_LONGEST]}..."
        if hasattr(type(value), "get_fields_and_field_types"):
            return self.message(value) if self._left > 0 else "..."
        if isinstance(value, Iterable):
            return self._items(value)
        return self._scalar(value)

    def _items(self, value: Any) -> Any:
        count = len(value)
        shown = min(count, _MOST_ITEMS, max(self._left, 0))
        items = [self._value(each) for each in islice(iter(value), shown)]
        return items if shown == count else [*items, {"more": count - shown}]

    def _scalar(self, value: Any) -> Any:
        """One of numpy's."""
        plain = value.item() if hasattr(value, "item") else str(value)
        return self._value(plain) if isinstance(plain, bool | int | float | str) else str(plain)


def _safe(value: bool | int | None) -> Any:
    """JavaScript's numbers are exact up to 2**53; beyond that a text says more."""
    return value if value is None or isinstance(value, bool) or abs(value) <= 2**53 else str(value)
