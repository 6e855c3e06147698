"""Serves the page on 127.0.0.1: its files, a stream of states, and the requests of its buttons.

States are sent as server-sent events: one way, over plain HTTP, and the browser reconnects on its own.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).parent
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    "": "text/plain; charset=utf-8",
}
_THREE = ("three/three.module.js", "three/three.core.js", "three/OrbitControls.js")
_FILES = {
    "/": "index.html",
    **{f"/{name}": name for name in ("style.css", "view.js", "robot.js")},
    **{f"/{name}": name for name in _THREE},
}
_KEEP_ALIVE = 5.0  # s between comments on an idle stream, so that a closed page is noticed
_PATIENCE = 10.0  # s for a client that sends nothing, or reads nothing
_HEADERS = {
    "Cache-Control": "no-store",
    # In a frame of another page, users could be tricked into clicking on something that they do not see.
    "Content-Security-Policy": "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class PageServer:
    """A web server on a thread of its own.

    `documents` are functions by path that make further pages on request, each (suffix of its type, text);
    `buttons` are the functions for POST requests, by path. The server's threads call both.
    """

    def __init__(
        self,
        port: int,
        documents: Mapping[str, Callable[[], tuple[str, str]]],
        buttons: Mapping[str, Callable[[], None]],
    ) -> None:
        self._documents = documents
        self._buttons = buttons
        self._news = threading.Condition()
        self._state = ""
        self._number = 0
        self._closed = False
        self._http = _Server(("127.0.0.1", port), type("Handler", (_Handler,), {"page": self}))
        self._thread = threading.Thread(target=self._http.serve_forever, name="web page", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port; if 0 was requested, the one that the system chose."""
        return int(self._http.server_address[1])

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.port}/"

    def show(self, state: Mapping[str, Any]) -> None:
        """Send a state to every open page; a slow page receives only the latest."""
        text = json.dumps(state, separators=(",", ":"), allow_nan=False)
        with self._news:
            self._state = text
            self._number += 1
            self._news.notify_all()

    def close(self) -> None:
        """End all streams and the server."""
        with self._news:
            self._closed = True
            self._news.notify_all()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    def document(self, path: str) -> tuple[str, str] | None:
        """A page made on request, as (suffix of its type, text)."""
        make = self._documents.get(path)
        return make() if make else None

    def press(self, path: str) -> bool:
        """Call a button's function; False if there is no such button."""
        action = self._buttons.get(path)
        if action is not None:
            action()
        return action is not None

    def next_state(self, seen: int) -> tuple[int, str] | None:
        """Wait for a state after number `seen`: its number and JSON, "" if none arrived; None at the end."""
        with self._news:
            self._news.wait_for(lambda: self._closed or self._number > seen, _KEEP_ALIVE)
            if self._closed:
                return None
            return (self._number, self._state) if self._number > seen else (seen, "")


class _Server(ThreadingHTTPServer):
    """A server with a thread for each client; it does not report clients that disconnect early."""

    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers one request; a subclass names the page.

    Only one, as in HTTP/1.0: anything else that a client sends is never treated as a second request.
    """

    timeout = _PATIENCE
    page: PageServer

    def do_GET(self) -> None:
        if not self._is_local():
            return
        if self.path == "/states":
            self._stream()
        elif self.path in _FILES:
            path = _FOLDER / _FILES[self.path]
            self._answer(_TYPES[path.suffix], path.read_bytes())
        elif (made := self.page.document(self.path)) is not None:
            self._answer(_TYPES[made[0]], made[1].encode())
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        # A page from another site cannot set this header without a preflight request, which is never granted.
        if not self._is_local():
            return
        if self.headers.get("X-Humanoid") != "1":
            self.send_error(HTTPStatus.FORBIDDEN)
        elif self.page.press(self.path):
            self._answer(_TYPES[""], b"")
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _is_local(self) -> bool:
        """Refuse host names that somebody else's DNS points here."""
        name = (self.headers.get("Host") or "").partition(":")[0]  # browsers leave port 80 out
        if name in {"127.0.0.1", "localhost"}:
            return True
        self.send_error(HTTPStatus.FORBIDDEN)
        return False

    def _stream(self) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        seen = 0
        while (news := self.page.next_state(seen)) is not None:
            seen, text = news
            self.wfile.write(f"data: {text}\n\n".encode() if text else b": still here\n\n")

    def _answer(self, content_type: str, body: bytes) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def end_headers(self) -> None:
        """Add the headers of every answer, including refusals."""
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: the terminal belongs to the demo."""
