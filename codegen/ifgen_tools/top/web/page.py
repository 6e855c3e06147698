"""The contents of the pages that are open: snapshots, pictures, and messages as trees of JSON."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from itertools import islice
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.top.snapshot import as_json
from ifgen_tools.top.web.picture import Structure, pictures, structure
from ifgen_tools.top.web.server import Server, Stream

if TYPE_CHECKING:
    from ifgen_tools.top.collector import Collector

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
