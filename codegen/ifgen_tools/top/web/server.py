"""Serves the page on 127.0.0.1: its files, and a stream of events for each page that is open.

Everything is read. A request that names another host, or comes from another page, is refused: neither a
name that somebody's DNS points here nor a page of somebody else gets an answer.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

_FOLDER: Final = Path(__file__).parent
_JAVASCRIPT: Final = "text/javascript; charset=utf-8"
_FILES: Final = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/style.css": ("style.css", "text/css; charset=utf-8"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
    **{
        f"/{name}.js": (f"{name}.js", "text/javascript; charset=utf-8")
        for name in ("top", "graph", "message")
    },
}
_HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_KEEP_ALIVE: Final = 5.0  # [s] between comments on an idle stream, so that a closed page is noticed
_PATIENCE: Final = 10.0  # [s] for a client that sends nothing, or reads nothing
_MOST_STREAMS: Final = 8
_MOST_TOPICS: Final = 60


class Stream:
    """An open page: the topic that it inspects, those that it shows, and what waits to be sent to it."""

    def __init__(self, inspected: str, shown: tuple[str, ...]) -> None:
        self.inspected = inspected
        self.shown = shown
        self.waiting: dict[str, str] = {}


class Server:
    """A web server on threads of its own. What is shown to a slow page is replaced by what is newer."""

    def __init__(self, port: int) -> None:
        self._news = threading.Condition()
        self._streams: list[Stream] = []
        self._latest: dict[str, str] = {}
        self._is_closed = False
        self._http = _Http(("127.0.0.1", port), type("Handler", (_Handler,), {"server_of": self}))
        self._thread = threading.Thread(target=self._http.serve_forever, name="web page", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port; if 0 was requested, the one that the system chose."""
        return int(self._http.server_address[1])

    @property
    def hosts(self) -> tuple[str, ...]:
        """The values that a Host header may have; browsers leave port 80 out."""
        hosts = tuple(f"{name}:{self.port}" for name in ("127.0.0.1", "localhost"))
        return hosts if self.port != 80 else (*hosts, "127.0.0.1", "localhost")

    def streams(self) -> tuple[Stream, ...]:
        """The pages that are open."""
        with self._news:
            return tuple(self._streams)

    def wait_for_pages(self, seconds: float) -> bool:
        """Wait until a page is open; returns whether one is."""
        with self._news:
            return bool(self._news.wait_for(lambda: self._streams, seconds))

    def show(self, kind: str, value: Mapping[str, Any]) -> None:
        """Send an event to every open page, and to those that are opened later."""
        text = _json(value)
        with self._news:
            self._latest[kind] = text
            for stream in self._streams:
                stream.waiting[kind] = text
            self._news.notify_all()

    def show_message(self, topic: str, value: Mapping[str, Any]) -> None:
        """Send a message to the pages that inspect its topic."""
        text = _json(value)
        with self._news:
            for stream in self._streams:
                if stream.inspected == topic:
                    stream.waiting["message"] = text
            self._news.notify_all()

    def open(self, inspected: str, shown: tuple[str, ...]) -> Stream | None:
        """Add a stream; None if there are too many."""
        stream = Stream(inspected, shown)
        with self._news:
            if len(self._streams) >= _MOST_STREAMS:
                return None
            self._streams.append(stream)
            stream.waiting.update(self._latest)
            self._news.notify_all()
        return stream

    def leave(self, stream: Stream) -> None:
        """Remove a stream."""
        with self._news:
            self._streams.remove(stream)

    def events(self, stream: Stream) -> dict[str, str] | None:
        """Wait for events of a stream, by kind: none if there is nothing new, None at the end."""
        with self._news:
            self._news.wait_for(lambda: self._is_closed or stream.waiting, _KEEP_ALIVE)
            if self._is_closed:
                return None
            found, stream.waiting = stream.waiting, {}
            return found

    def close(self) -> None:
        """End all streams and the server."""
        with self._news:
            self._is_closed = True
            self._news.notify_all()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()


def _json(value: Mapping[str, Any]) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


class _Http(ThreadingHTTPServer):
    """A server with a thread for each client; it does not report clients that disconnect early."""

    daemon_threads = True
    block_on_close = False

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers one request, and only one: a body is never taken for a second request."""

    timeout = _PATIENCE
    server_of: Server

    def do_GET(self) -> None:
        if not self._is_from_here():
            self._refuse(HTTPStatus.FORBIDDEN)
            return
        try:
            path = urlsplit(self.path)
            query = parse_qs(path.query, max_num_fields=2 * _MOST_TOPICS)
        except ValueError:  # of an address in brackets that is none, or of too many fields
            self._refuse(HTTPStatus.BAD_REQUEST)
            return
        if path.path == "/events":
            self._stream(query)
        elif path.path in _FILES:
            name, content_type = _FILES[path.path]
            body = (_FOLDER / name).read_bytes()
            self._begin(HTTPStatus.OK, content_type, len(body))
            self.wfile.write(body)
        else:
            self._refuse(HTTPStatus.NOT_FOUND)

    def _is_from_here(self) -> bool:
        headers, hosts = self.headers, self.server_of.hosts
        origins = headers.get_all("Origin") or []
        sites = headers.get_all("Sec-Fetch-Site") or []
        return (
            len(headers.get_all("Host") or []) == 1
            and headers["Host"] in hosts
            and all(origin in {f"http://{host}" for host in hosts} for origin in origins)
            and all(site in {"same-origin", "none"} for site in sites)
        )

    def _stream(self, query: Mapping[str, list[str]]) -> None:
        shown = tuple(query.get("shown", ()))[:_MOST_TOPICS]
        stream = self.server_of.open(query.get("inspected", [""])[0], shown)
        if stream is None:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE)
            return
        try:
            self._begin(HTTPStatus.OK, "text/event-stream")
            while (events := self.server_of.events(stream)) is not None:
                text = "".join(f"event: {kind}\ndata: {data}\n\n" for kind, data in events.items())
                self.wfile.write((text or ": still here\n\n").encode())
        finally:
            self.server_of.leave(stream)

    def _begin(self, status: HTTPStatus, content_type: str, length: int | None = None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", content_type)
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.end_headers()

    def _refuse(self, status: HTTPStatus) -> None:
        body = f"{status.phrase}\n".encode()
        self._begin(status, "text/plain; charset=utf-8", len(body))
        self.wfile.write(body)

    def end_headers(self) -> None:
        """Add the headers of every answer, including refusals."""
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def version_string(self) -> str:
        """Say nothing about Python."""
        return "ifgen"

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: the terminal has the address of the page."""
