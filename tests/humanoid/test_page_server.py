"""The server of the demo's page and clients that are not browsers: none blocks a thread or causes a traceback."""

from __future__ import annotations

import hashlib
import re
import socket
import struct
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

import pytest

pytest.importorskip("mujoco")
from humanoid.show.web import server

WEB = Path(server.__file__).parent
BIG: dict[str, Any] = {"text": "x" * 2**20}
LINGER_NOT = struct.pack("ii", 1, 0)


Asked = list[Mapping[str, Any]]


@pytest.fixture(scope="module")
def asked() -> Asked:
    """The commands that reached the robot."""
    return []


@pytest.fixture(scope="module")
def page(asked: Asked) -> Iterator[server.PageServer]:
    documents = {"/made": lambda: ("", b"made"), "/big": lambda: ("", b"x" * 2**25)}
    made = server.PageServer(0, documents, lambda command: (not asked.append(command), "done"))
    yield made
    made.close()


def connected(page: server.PageServer) -> socket.socket:
    return socket.create_connection(("127.0.0.1", page.port), timeout=20)


def answer(page: server.PageServer, request: str, token: str | None = None) -> str:
    """Everything that arrives until the server closes the connection, for a browser that has the token."""
    cookie = f"Cookie: humanoid_{page.port}={page.token if token is None else token}"
    head, empty, body = request.partition("\n\n")
    with connected(page) as client:
        client.sendall(f"{head}\n{cookie}{empty}{body}".replace("\n", "\r\n").encode())
        return b"".join(iter(lambda: client.recv(2**16), b"")).decode()


def request(page: server.PageServer, path: str) -> bytes:
    cookie = f"humanoid_{page.port}={page.token}"
    return f"GET {path} HTTP/1.1\r\nHost: localhost\r\nCookie: {cookie}\r\n\r\n".encode()


def wait_for_threads(before: list[threading.Thread]) -> None:
    """Those of clients of earlier tests may go on: the server hears of a closed page after some seconds."""
    for thread in set(threading.enumerate()) - set(before):
        thread.join(20)
    assert set(threading.enumerate()) <= set(before)


def test_only_its_own_names_reach_it(page: server.PageServer) -> None:
    """Browsers do not name port 80."""
    for host in ("127.0.0.1", "localhost", f"127.0.0.1:{page.port}", f"localhost:{page.port}"):
        assert answer(page, f"GET /made HTTP/1.1\nHost: {host}\n\n").endswith("\r\n\r\nmade")
    strange = ("", "evil.example", "127.0.0.1.evil.example", f"evil.example:{page.port}", "[::1]:80")
    for host in (*strange, "127.0.0.1:80@evil.example", f"127.0.0.1:{page.port}@evil.example", "127.0.0.1:1"):
        assert answer(page, f"GET /made HTTP/1.1\nHost: {host}\n\n").startswith("HTTP/1.0 403 "), host
        entrance = answer(page, f"GET /?token={page.token} HTTP/1.1\nHost: {host}\n\n")
        assert entrance.startswith("HTTP/1.0 403 "), host
    twice = "GET /made HTTP/1.1\nHost: localhost\nHost: evil.example\n\n"
    assert answer(page, twice).startswith("HTTP/1.0 403 ")


@pytest.mark.parametrize("path", ["/", "/made", "/news", "/view.js"])
@pytest.mark.parametrize(
    "header",
    [
        "Origin: http://evil.example",
        "Origin: null",
        "Sec-Fetch-Site: cross-site",
        "Sec-Fetch-Site: same-site",
    ],
)
def test_other_sites_get_nothing(path: str, header: str, page: server.PageServer) -> None:
    assert answer(page, f"GET {path} HTTP/1.1\nHost: localhost\n{header}\n\n").startswith("HTTP/1.0 403 ")


@pytest.mark.parametrize("path", ["/", "/made", "/nothing"])
def test_no_other_page_can_frame_it_and_it_runs_no_other_scripts(page: server.PageServer, path: str) -> None:
    headers = answer(page, f"GET {path} HTTP/1.1\nHost: localhost\n\n").partition("\r\n\r\n")[0].split("\r\n")
    assert "X-Frame-Options: DENY" in headers
    assert "Cross-Origin-Resource-Policy: same-origin" in headers
    (policy,) = (line for line in headers if line.startswith("Content-Security-Policy: "))
    for part in (
        "default-src 'none'; script-src 'self' 'sha256-",
        "frame-ancestors 'none'",
        "base-uri 'none'",
    ):
        assert part in policy
    assert "unsafe" not in policy


def command(host: str, *headers: str, body: str = '{"do": "stop"}') -> str:
    lines = (f"Host: {host}", f"Content-Length: {len(body)}", *headers)
    return "POST /command HTTP/1.1\n" + "\n".join(lines) + "\n\n" + body


@pytest.mark.parametrize("method", ["GET /made", "POST /command"])
def test_a_body_is_no_second_request(method: str, page: server.PageServer, asked: Asked) -> None:
    inner = command("localhost", "X-Humanoid: 1")
    outer = f"{method} HTTP/1.1\nHost: localhost\nConnection: keep-alive\nContent-Length: {len(inner)}\n\n"
    assert answer(page, outer + inner).count("HTTP/1.") == 1
    assert asked == []


def test_only_the_page_itself_commands(page: server.PageServer, asked: Asked) -> None:
    own = f"127.0.0.1:{page.port}"
    for refused in (
        command(own),  # a form of another site cannot set our header
        command(own, "X-Humanoid: 1", "Origin: http://evil.example"),
        command(own, "X-Humanoid: 1", "Origin: null"),
        command(own, "X-Humanoid: 1", f"Origin: http://localhost:{page.port}"),
        command(own, "X-Humanoid: 1", f"Origin: https://{own}"),
        command("evil.example", "X-Humanoid: 1", "Origin: http://evil.example"),
    ):
        assert answer(page, refused).startswith("HTTP/1.0 403 "), refused
    assert asked == []
    for accepted in (
        command(own, "X-Humanoid: 1"),
        command(own, "X-Humanoid: 1", f"Origin: http://{own}"),
    ):
        assert answer(page, accepted).endswith('{"accepted": true, "text": "done"}')
    assert asked == [{"do": "stop"}] * 2
    asked.clear()


@pytest.mark.parametrize(
    ("body", "length", "status"),
    [
        ("stop", "4", 400),
        ("[1]", "3", 400),
        ("[" * 4000, "4000", 400),
        ("{}", "4097", 413),
        ("{}", "-1", 413),
        ("{}", "", 413),
        ("{}", "9" * 5000, 413),
        ("{}", "0" * 5000 + "2", 413),
        ("{}", "²", 413),
    ],
)
def test_what_is_no_command(
    body: str,
    length: str,
    status: int,
    page: server.PageServer,
    asked: Asked,
    capfd: pytest.CaptureFixture[str],
) -> None:
    request = f"POST /command HTTP/1.1\nHost: localhost\nX-Humanoid: 1\nContent-Length: {length}\n\n{body}"
    assert answer(page, request).startswith(f"HTTP/1.0 {status} ")
    assert asked == []
    assert capfd.readouterr().err == ""


def test_an_address_that_is_none_is_refused(
    page: server.PageServer, capfd: pytest.CaptureFixture[str]
) -> None:
    for target in ("http://[", "//[x", "/?token=%ff%00", "/%", "*"):
        status = answer(page, f"GET {target} HTTP/1.1\nHost: localhost\n\n").split(" ")[1]
        assert status in ("400", "404", "200"), target
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("address", ["127.0.0.1", "0.0.0.0"])
def test_nobody_gets_anything_without_the_token(address: str) -> None:
    """Other users of this machine reach the port, too."""
    page = server.PageServer(0, {}, lambda _: (True, "done"), address)
    try:
        assert len(page.token) > 20
        assert re.fullmatch(rf"http://[\w.-]+:{page.port}/\?token={page.token}", page.url)
        assert "//0.0.0.0:" not in page.url  # which no other machine can open
        name = f"humanoid_{page.port}"
        host = f"127.0.0.1:{page.port}" if address == "127.0.0.1" else f"robot.local:{page.port}"
        for token in ("", "wrong", ";=", "é"):
            for path in ("/", "/news", "/view.js", "/?token=wrong", "/?token="):
                request = f"GET {path} HTTP/1.1\nHost: {host}\n\n"
                assert answer(page, request, token).startswith("HTTP/1.0 403 "), request
        assert "403" in answer(page, command(host, "X-Humanoid: 1"), "wrong")
        entrance = answer(page, f"GET /?token={page.token} HTTP/1.1\nHost: {host}\n\n", "")
        assert entrance.startswith("HTTP/1.0 303 ")
        assert "\r\nLocation: /\r\n" in entrance
        kept = f"\r\nSet-Cookie: {name}={page.token}; HttpOnly; SameSite=Strict; Path=/\r\n"
        assert kept in entrance
        assert "<title>" in answer(page, f"GET / HTTP/1.1\nHost: {host}\n\n")
        ours = "X-Humanoid: 1"
        assert "403" in answer(page, command(host, ours, "Origin: http://evil.example"))
        assert answer(page, command(host, ours, f"Origin: http://{host}")).endswith('"text": "done"}')
    finally:
        page.close()


def test_pages_that_come_late_get_the_present_state(page: server.PageServer) -> None:
    page.show("mode", "walking")
    page.show("time", 1.5)
    page.show("time", 2.5)
    with connected(page) as client:
        client.sendall(request(page, "/news"))
        seen = b""
        while b"2.5" not in seen:
            seen += client.recv(2**16)
        assert b'event: mode\ndata: "walking"\n\n' in seen
        assert b"1.5" not in seen
        assert page.watchers == 1
        page.show("mode", "walking")  # no news
        page.show("time", 3.5)
        assert client.recv(2**16) == b"event: time\ndata: 3.5\n\n"


def test_who_says_nothing_is_not_waited_for(page: server.PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    assert 0 < server._Handler.timeout <= 10
    monkeypatch.setattr(server._Handler, "timeout", 0.1)
    before = threading.enumerate()
    clients = [connected(page) for _ in range(20)]
    for client in clients:
        client.sendall(b"GET / HT")
    for client in clients:
        assert client.recv(1) == b""
        client.close()
    wait_for_threads(before)


def test_who_takes_nothing_is_not_waited_for(
    page: server.PageServer, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(server._Handler, "timeout", 0.1)
    before = threading.enumerate()
    with connected(page) as client:
        client.sendall(request(page, "/news"))
        assert client.recv(4) == b"HTTP"
        workers = [thread for thread in threading.enumerate() if thread not in before]
        assert len(workers) == 1
        for number in range(200):
            page.show("big", BIG | {"number": number})
            workers[0].join(0.1)
            if not workers[0].is_alive():
                break
        wait_for_threads(before)
    assert capfd.readouterr().err == ""


def test_who_resets_is_not_spoken_of(page: server.PageServer, capfd: pytest.CaptureFixture[str]) -> None:
    before = threading.enumerate()
    for path in ("/news", "/big"):
        with connected(page) as client:
            client.sendall(request(page, path))
            assert client.recv(4) == b"HTTP"
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, LINGER_NOT)
    for number in range(200):
        page.show("big", BIG | {"number": number})
        if set(threading.enumerate()) <= set(before):
            break
    wait_for_threads(before)
    assert capfd.readouterr().err == ""


def test_three_js_is_what_its_table_says() -> None:
    folder = WEB / "three"
    rows = re.findall(r"^\| ([0-9a-f]{64}) \| (\S+) \|", (folder / "README.md").read_text(), re.MULTILINE)
    found = {(hashlib.sha256(path.read_bytes()).hexdigest(), path.name) for path in folder.iterdir()}
    assert set(rows) == {(digest, name) for digest, name in found if name != "README.md"}


def test_the_page_needs_nothing_from_elsewhere(page: server.PageServer) -> None:
    """Every file that the page or one of its scripts names is served by it."""
    names = {"three": "/three/three.module.js"}  # of the page's import map
    seen: set[str] = set()
    waiting = {"/"}
    while waiting:
        path = waiting.pop()
        seen.add(path)
        head, _, text = answer(page, f"GET {path} HTTP/1.1\nHost: localhost\n\n").partition("\r\n\r\n")
        assert head.startswith("HTTP/1.0 200 "), path
        pattern = r"""(?:src|href)="([^"]+)"|^(?:import|export)? ?[^;'"/*]*\bfrom ['"]([^'"]+)['"];$"""
        found = {one or other for one, other in re.findall(pattern, text, re.MULTILINE)}
        wanted = {urljoin(path, names.get(name, name)) for name in found if not name.startswith("data:")}
        waiting |= wanted - seen
    assert seen >= {"/view.js", "/style.css", "/three/three.core.js", "/three/OrbitControls.js"}
