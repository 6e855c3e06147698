"""The server of the demo's page and clients that are not browsers: none blocks a thread or causes a traceback."""

from __future__ import annotations

import hashlib
import re
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urljoin

import pytest

pytest.importorskip("mujoco")
from humanoid.show.web import server

WEB = Path(server.__file__).parent
BIG = {"text": "x" * 2**20}
LINGER_NOT = struct.pack("ii", 1, 0)


@pytest.fixture(scope="module")
def page() -> Iterator[server.PageServer]:
    pressed = [0]

    def press() -> None:
        pressed[0] += 1

    documents = {
        "/made": lambda: ("", "made"),
        "/count": lambda: ("", str(pressed)),
        "/big": lambda: ("", "x" * 2**25),
    }
    made = server.PageServer(0, documents, {"/press": press})
    yield made
    made.close()


def connected(page: server.PageServer) -> socket.socket:
    return socket.create_connection(("127.0.0.1", page.port), timeout=20)


def answer(page: server.PageServer, request: str) -> str:
    """Everything that arrives until the server closes the connection."""
    with connected(page) as client:
        client.sendall(request.replace("\n", "\r\n").encode())
        return b"".join(iter(lambda: client.recv(2**16), b"")).decode()


def wait_for_threads(count: int) -> None:
    for thread in threading.enumerate():
        if thread.name.startswith("Thread-") and "process_request_thread" in thread.name:
            thread.join(20)
    assert threading.active_count() <= count


def test_port_80_is_not_named_by_browsers(page: server.PageServer) -> None:
    for host in ("127.0.0.1", "localhost", f"127.0.0.1:{page.port}"):
        assert answer(page, f"GET /made HTTP/1.1\nHost: {host}\n\n").endswith("\r\n\r\nmade")
    for host in ("", "evil.example", "127.0.0.1.evil.example", f"evil.example:{page.port}", "[::1]:80"):
        assert answer(page, f"GET /made HTTP/1.1\nHost: {host}\n\n").startswith("HTTP/1.0 403 ")


@pytest.mark.parametrize("path", ["/", "/made", "/nothing"])
def test_no_other_page_can_frame_it(page: server.PageServer, path: str) -> None:
    headers = answer(page, f"GET {path} HTTP/1.1\nHost: localhost\n\n").partition("\r\n\r\n")[0].split("\r\n")
    assert "X-Frame-Options: DENY" in headers
    assert "Content-Security-Policy: frame-ancestors 'none'" in headers


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_body_is_no_second_request(page: server.PageServer, method: str) -> None:
    inner = "POST /press HTTP/1.1\nHost: localhost\nX-Humanoid: 1\n\n"
    outer = (
        f"{method} /made HTTP/1.1\nHost: localhost\nConnection: keep-alive\nContent-Length: {len(inner)}\n\n"
    )
    assert answer(page, outer + inner).count("HTTP/1.") == 1
    assert answer(page, "GET /count HTTP/1.1\nHost: localhost\n\n").endswith("[0]")


def test_who_says_nothing_is_not_waited_for(page: server.PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    assert 0 < server._Handler.timeout <= 10
    monkeypatch.setattr(server._Handler, "timeout", 0.1)
    before = threading.active_count()
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
    before = threading.active_count()
    with connected(page) as client:
        client.sendall(b"GET /states HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert client.recv(4) == b"HTTP"
        workers = [t for t in threading.enumerate() if "process_request_thread" in t.name]
        assert len(workers) == 1
        for _ in range(200):
            page.show(BIG)
            workers[0].join(0.1)
            if not workers[0].is_alive():
                break
        wait_for_threads(before)
    assert capfd.readouterr().err == ""


def test_who_resets_is_not_spoken_of(page: server.PageServer, capfd: pytest.CaptureFixture[str]) -> None:
    before = threading.active_count()
    for path in ("/states", "/big"):
        with connected(page) as client:
            client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            assert client.recv(4) == b"HTTP"
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, LINGER_NOT)
    for _ in range(200):
        page.show(BIG)
        if threading.active_count() <= before:
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
