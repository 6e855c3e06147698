"""Gathers for the pages that are open, and tells them."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Final

from ifgen_tools.errors import ToolError
from ifgen_tools.top.snapshot import as_json
from ifgen_tools.top.web.picture import Structure, pictures, structure
from ifgen_tools.top.web.server import Server, Stream
from ifgen_tools.top.web.tree import tree

if TYPE_CHECKING:
    from ifgen_tools.top.gathering import Gatherer

_TURN: Final = 0.05  # [s] between two messages of an inspected topic
_IDLE: Final = 0.5  # [s] between two looks whether a page is open


class Page:
    """The pages that are open, and what they have been sent."""

    def __init__(self, server: Server, gatherer: Gatherer) -> None:
        self._server = server
        self._gatherer = gatherer
        self._structure: Structure | None = None
        self._shown: dict[str, bytes] = {}  # the message of each topic that was sent last
        self._streams: tuple[Stream, ...] = ()

    def look(self) -> None:
        """Take a snapshot and send it, with a picture if the graph has changed."""
        self._want()
        snapshot = self._gatherer.step()
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
            self._gatherer.listen()
        for topic in {stream.inspected for stream in self._streams}:
            tap = self._gatherer.tap(topic)
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
        self._gatherer.want([*inspected, *(topic for stream in streams for topic in stream.shown)])


def serve(gatherer: Gatherer, port: int, period: float) -> None:
    """Serve the page until Ctrl-C; nothing is asked or listened to while no page is open."""
    try:
        server = Server(port)
    except OSError as error:
        raise ToolError(
            f"port {port} of 127.0.0.1 cannot be used: {error.strerror or error}",
            "name another one with --port, or 0 for any",
        ) from None
    print(f"ifgen top: http://127.0.0.1:{server.port}/ (Ctrl-C ends it)", flush=True)
    page = Page(server, gatherer)
    try:
        while True:
            if not server.wait_for_pages(0):
                gatherer.close()
                while not server.wait_for_pages(_IDLE):
                    gatherer.spin(0)
            page.look()
            end = time.monotonic() + period
            while (left := end - time.monotonic()) > 0:
                page.send_messages()
                gatherer.spin(min(_TURN, left))
    finally:
        server.close()
