"""The server of the page, and clients that are not its page."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest
from ifgen.command_kit.tool import ToolError
from ifgen_tools.top.web import server
from ifgen_tools.top.web.page import serve
from ifgen_tools.top.web.server import Server

LIMIT = 20.0  # [s]


@pytest.fixture
def page() -> Iterator[Server]:
    made = Server(0)
    yield made
    made.close()


def connected(page: Server, request: str) -> socket.socket:
    client = socket.create_connection(("127.0.0.1", page.port), timeout=LIMIT)
    client.sendall(request.replace("\n", "\r\n").encode())
    return client


def answer(page: Server, path: str = "/", *headers: str, host: str | None = None, method: str = "GET") -> str:
    """Everything that comes until the server closes the connection."""
    host = f"127.0.0.1:{page.port}" if host is None else host
    lines = "".join(f"{header}\n" for header in headers)
    with connected(page, f"{method} {path} HTTP/1.1\nHost: {host}\n{lines}\n") as client:
        return b"".join(iter(lambda: client.recv(2**16), b"")).decode()


def stream(page: Server, query: str = "") -> socket.socket:
    client = connected(page, f"GET /events?{query} HTTP/1.1\nHost: 127.0.0.1:{page.port}\n\n")
    assert client.recv(15) == b"HTTP/1.0 200 OK"
    return client


def until(client: socket.socket, words: bytes) -> bytes:
    found = b""
    while words not in found:
        more = client.recv(2**16)
        assert more, found
        found += more
    return found


@pytest.mark.parametrize("path", ["http://[", "/events?" + "&".join(["shown=x"] * 200)])
def test_addresses_that_are_none_are_refused(
    page: Server, path: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert answer(page, path).startswith("HTTP/1.0 400 ")
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("path", ["/", "/style.css", "/top.js", "/graph.js", "/message.js", "/icon.svg"])
def test_files_are_served_to_their_page_only(page: Server, path: str) -> None:
    text = answer(page, path, f"Origin: http://localhost:{page.port}", "Sec-Fetch-Site: same-origin")
    assert text.startswith("HTTP/1.0 200 ")
    assert "default-src 'none'; script-src 'self'" in text
    assert "X-Frame-Options: DENY" in text
    assert "Access-Control" not in text


@pytest.mark.parametrize("path", ["/", "/events", "/top.js", "/nothing"])
def test_others_get_no_answer(page: Server, path: str) -> None:
    refused = "HTTP/1.0 403 "
    for host in ("", "evil.example", "127.0.0.1", f"evil.example:{page.port}", "127.0.0.1:1", "[::1]:80"):
        assert answer(page, path, host=host).startswith(refused)
    for header in (
        "Origin: http://evil.example",
        "Origin: null",
        f"Origin: https://127.0.0.1:{page.port}",
        "Origin: http://127.0.0.1",
        "Sec-Fetch-Site: cross-site",
        "Sec-Fetch-Site: same-site",
        "Host: evil.example",
    ):
        assert answer(page, path, header).startswith(refused)


@pytest.mark.parametrize("path", ["/nothing", "/../server.py", "/server.py", "/%2e%2e/run.py", "/style.css/"])
def test_nothing_else_is_served(page: Server, path: str) -> None:
    assert answer(page, path).startswith("HTTP/1.0 404 ")


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "HEAD"])
def test_there_is_nothing_to_change(page: Server, method: str) -> None:
    assert answer(page, "/", method=method).startswith("HTTP/1.0 501 ")


def test_a_page_gets_what_is_new_and_messages_of_its_topic(page: Server) -> None:
    page.show("snapshot", {"number": 0.1})
    with stream(page, "inspected=/imu&shown=/imu&shown=/odom") as client:
        until(client, b'event: snapshot\ndata: {"number":0.1}\n\n')
        (opened,) = page.streams()
        assert (opened.inspected, opened.shown) == ("/imu", ("/imu", "/odom"))
        page.show_message("/odom", {"topic": "/odom"})
        page.show_message("/imu", {"topic": "/imu"})
        assert b"/odom" not in until(client, b'event: message\ndata: {"topic":"/imu"}\n\n')


def test_pages_are_few(page: Server) -> None:
    clients = [stream(page) for _ in range(8)]
    assert answer(page, "/events").startswith("HTTP/1.0 503 ")
    for client in clients:
        client.close()


def test_what_a_page_wants_is_bounded(page: Server) -> None:
    with stream(page, "&".join(f"shown=/t{number}" for number in range(100))):
        assert len(page.streams()[0].shown) == 60


def test_who_reads_nothing_holds_up_nobody(page: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server._Handler, "timeout", 0.1)
    with stream(page, "inspected=/imu"):
        for _ in range(2000):
            page.show_message("/imu", {"text": "x" * 2**18})
            if not page.streams():
                break
            threading.Event().wait(0.005)
        assert page.streams() == ()
    assert answer(page).startswith("HTTP/1.0 200 ")


def test_who_leaves_is_noticed(page: Server, capfd: pytest.CaptureFixture[str]) -> None:
    stream(page).close()
    for _ in range(200):
        page.show("snapshot", {})
        if not page.streams():
            break
        threading.Event().wait(0.01)
    assert page.streams() == ()
    assert capfd.readouterr().err == ""


def test_a_port_that_is_taken(page: Server) -> None:
    with pytest.raises(ToolError, match=f"port {page.port} of 127.0.0.1 cannot be used") as refused:
        serve(None, page.port, 1.0)  # type: ignore[arg-type]  # it does not come to that
    assert "--port" in refused.value.help
