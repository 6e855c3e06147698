"""Serves the page: its files, a stream of what happens, and the commands of its visitors.

What happens is sent as server-sent events: one way, over plain HTTP, and the browser reconnects on its own.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import re
import secrets
import socket
import sys
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

_FOLDER = Path(__file__).parent
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".json": "application/json",
    ".jpg": "image/jpeg",
    "": "text/plain; charset=utf-8",
}
_THREE = ("three/three.module.js", "three/three.core.js", "three/OrbitControls.js")
_OWN = ("style.css", "view.js", "scene.js", "robot.js", "panel.js", "graph.js", "hands.js")
_FILES = {"/": "index.html", **{f"/{name}": name for name in (*_OWN, *_THREE)}}
LOOPBACK = "127.0.0.1"
_ANY = "0.0.0.0"
_ELSEWHERE = ("192.0.2.1", 9)  # an address for documentation (RFC 5737): nothing is ever sent there
_LONGEST = 4096  # bytes of a command
_KEEP_ALIVE = 5.0  # s between comments on an idle stream, so that a closed page is noticed
_PATIENCE = 10.0  # s for a client that sends nothing, or reads nothing
_TOKEN = 18  # bytes
_MAP = re.compile(r'<script type="importmap">(.*?)</script>', re.DOTALL)
_NEWS = "/news"
_OUR_SITES = {"same-origin", "none"}  # values of Sec-Fetch-Site; none: a person has typed the address


def _policy() -> str:
    """What the page may load and run: its own files, and the import map in it, which cannot be a file."""
    found = _MAP.search((_FOLDER / "index.html").read_text(encoding="utf-8"))
    assert found is not None, "index.html has an import map"
    digest = base64.b64encode(hashlib.sha256(found[1].encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'self' 'sha256-{digest}'; style-src 'self'; "
        "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'self'; "
        # In a frame of another page, users could be tricked into clicking on something that they do not see.
        "frame-ancestors 'none'"
    )


_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": _policy(),
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # the address may hold the token
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}

Document = tuple[str, bytes]
"""The suffix of its type, and its bytes."""
Answer = tuple[bool, str]
"""Whether a command was accepted, and what came of it or why not, in words."""


class PageServer:
    """A web server on a thread of its own.

    `documents` are functions by path that make further pages on request; `ask` does a command, and may take
    its time. The server's threads call both. Nobody gets anything without the token, which the page's address
    has: other users of this machine can reach the port, too.
    """

    def __init__(
        self,
        port: int,
        documents: Mapping[str, Callable[[], Document]],
        ask: Callable[[Mapping[str, Any]], Answer],
        host: str = LOOPBACK,
    ) -> None:
        self.documents = documents
        self.ask = ask
        self.token = secrets.token_urlsafe(_TOKEN)
        self._host = host
        self._news = threading.Condition()
        self._channels: dict[str, tuple[int, str]] = {}  # number of the change, JSON
        self._number = 0
        self._streams = 0
        self._closed = False
        self._http = _Server((host, port), type("Handler", (_Handler,), {"page": self}))
        self._thread = threading.Thread(target=self._http.serve_forever, name="web page", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port; if 0 was requested, the one that the system chose."""
        return int(self._http.server_address[1])

    @property
    def url(self) -> str:
        """The address of the page, with its token."""
        host = _own_address() if self._host == _ANY else self._host
        return f"http://{host}:{self.port}/?token={self.token}"

    @property
    def hosts(self) -> tuple[str, ...] | None:
        """What a Host header may be; None if this machine has names that we do not know.

        Browsers leave port 80 out.
        """
        if self._host != LOOPBACK:
            return None
        return tuple(f"{name}{port}" for name in (LOOPBACK, "localhost") for port in ("", f":{self.port}"))

    @property
    def watchers(self) -> int:
        """The number of open pages."""
        return self._streams

    def show(self, channel: str, value: object) -> None:
        """Send a value to every open page unless it is the last one; a slow page gets only the newest."""
        text = json.dumps(value, separators=(",", ":"), allow_nan=False)
        with self._news:
            if self._channels.get(channel, (0, ""))[1] != text:
                self._number += 1
                self._channels[channel] = self._number, text
                self._news.notify_all()

    def close(self) -> None:
        """End all streams and the server."""
        with self._news:
            self._closed = True
            self._news.notify_all()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    def news(self, seen: int) -> tuple[int, list[tuple[str, str]]] | None:
        """Wait for values after change number `seen`.

        Returns the number of the newest, and (channel, JSON) of each, none if nothing came; None at the end.
        """
        with self._news:
            self._news.wait_for(lambda: self._closed or self._number > seen, _KEEP_ALIVE)
            if self._closed:
                return None
            new = [(name, text) for name, (number, text) in self._channels.items() if number > seen]
            return self._number, new

    def count(self, difference: int) -> None:
        """Note that a page was opened (1) or closed (-1)."""
        with self._news:
            self._streams += difference


def _own_address() -> str:
    """The address of this machine in its network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(_ELSEWHERE)  # chooses a route, without a packet
            return str(probe.getsockname()[0])
        except OSError:
            return socket.gethostname()


class _Server(ThreadingHTTPServer):
    """A server with a thread for each client; it does not report clients that disconnect early."""

    daemon_threads = True
    request_queue_size = 128  # of a full queue, the system takes no visitor before a second or more

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
        try:
            place = urlsplit(self.path)
        except ValueError:
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        path = place.path
        if not self._names_us():
            return
        if self._brings_token(place.query):
            self._keep_token(path)
        elif not self._may_enter():
            return
        elif path == _NEWS:
            self._stream()
        elif path in _FILES:
            file = _FOLDER / _FILES[path]
            self._answer(_TYPES[file.suffix], file.read_bytes())
        elif (make := self.page.documents.get(path)) is not None:
            suffix, body = make()
            self._answer(_TYPES[suffix], body)
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        if not (self._names_us() and self._may_enter() and self._may_command()):
            return
        if self.path != "/command":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        length = self.headers.get("Content-Length") or ""
        # Python refuses to convert thousands of digits.
        is_number = length.isascii() and length.isdigit() and len(length) <= len(str(_LONGEST))
        if not is_number or int(length) > _LONGEST:
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a command has at most {_LONGEST} bytes")
            return
        try:
            command = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            command = None
        if not isinstance(command, dict):
            self.send_error(HTTPStatus.BAD_REQUEST, "a command is an object in JSON")
            return
        accepted, text = self.page.ask(command)
        self._answer(_TYPES[".json"], json.dumps({"accepted": accepted, "text": text}).encode())

    @property
    def _cookie(self) -> str:
        return f"humanoid_{self.page.port}"  # browsers send cookies to all ports of a host

    def _brings_token(self, query: str) -> bool:
        """Whether the address has the token."""
        given = parse_qs(query).get("token", [""])[-1]
        return hmac.compare_digest(given.encode(), self.page.token.encode())

    def _keep_token(self, path: str) -> None:
        """Let the browser remember the token, and forget the address that has it."""
        self.send_response(HTTPStatus.SEE_OTHER)
        self.send_header("Set-Cookie", f"{self._cookie}={self.page.token}; HttpOnly; SameSite=Strict; Path=/")
        self.send_header("Location", path if path in _FILES else "/")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def _may_enter(self) -> bool:
        """Refuse whoever has no token, and what a page of another site asks for."""
        try:
            given = SimpleCookie(self.headers.get("Cookie", "")).get(self._cookie)
        except CookieError:
            given = None
        token = given.value if given else ""
        if not hmac.compare_digest(token.encode(), self.page.token.encode()):
            self.send_error(HTTPStatus.FORBIDDEN, "open the address with the token that the demo has printed")
            return False
        origins = self.headers.get_all("Origin") or []
        sites = self.headers.get_all("Sec-Fetch-Site") or []
        own = f"http://{self.headers['Host']}"
        if all(origin == own for origin in origins) and all(site in _OUR_SITES for site in sites):
            return True
        self.send_error(HTTPStatus.FORBIDDEN, "this is for the page itself, not for other sites")
        return False

    def _names_us(self) -> bool:
        """Refuse host names that somebody else's DNS points here."""
        hosts, given = self.page.hosts, self.headers.get_all("Host") or []
        if len(given) == 1 and (hosts is None or given[0] in hosts):
            return True
        self.send_error(HTTPStatus.FORBIDDEN, "this page is for 127.0.0.1 only")
        return False

    def _may_command(self) -> bool:
        """Refuse forms of other sites, which cannot set our header."""
        if self.headers.get("X-Humanoid") == "1":
            return True
        self.send_error(HTTPStatus.FORBIDDEN, "only the page itself may send commands")
        return False

    def _stream(self) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        self.page.count(1)
        try:
            seen = 0
            while (found := self.page.news(seen)) is not None:
                seen, values = found
                text = "".join(f"event: {channel}\ndata: {value}\n\n" for channel, value in values)
                self.wfile.write(text.encode() or b": still here\n\n")
        finally:
            self.page.count(-1)

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
