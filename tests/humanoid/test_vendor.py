"""The download of `ifgen demo --web` is cached, whole or not at all; each failure is one sentence."""

from __future__ import annotations

import base64
import hashlib
import io
import tarfile
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from humanoid.show.web import vendor


class Registry(BaseHTTPRequestHandler):
    """Answers every request with `data`."""

    data = b""
    announced = ""

    def do_GET(self) -> None:
        self.send_response(200)
        if self.announced == "chunked":
            self.send_header("Transfer-Encoding", "chunked")
        elif self.announced:
            self.send_header("Content-Length", self.announced)
        self.end_headers()
        self.wfile.write(self.data)

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def registry(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[type[Registry]]:
    handler = type("Handler", (Registry,), {"data": archive(), "announced": ""})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    monkeypatch.setenv("npm_config_registry", f"http://127.0.0.1:{server.server_address[1]}")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    digest = base64.b64encode(hashlib.sha512(archive()).digest()).decode()
    monkeypatch.setattr(vendor, "INTEGRITY", digest)
    yield handler
    server.shutdown()
    server.server_close()


def archive() -> bytes:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w") as packed:
        for name in vendor._FILES:
            member = tarfile.TarInfo(name)
            member.size = len(name)
            packed.addfile(member, io.BytesIO(name.encode()))
    return data.getvalue()


def test_it_goes_to_the_cache_folder(registry: type[Registry], tmp_path: Path) -> None:
    assert not vendor.present()
    vendor.fetch()
    assert vendor.present()
    assert vendor.folder().is_relative_to(tmp_path / "cache")
    assert {path.name for path in vendor.folder().iterdir()} == set(vendor._FILES.values())
    assert [path.name for path in vendor.folder().parent.iterdir()] == [vendor.folder().name]
    registry.data = b""
    vendor.fetch()  # sends no request


@pytest.mark.parametrize(
    ("data", "announced", "reason"),
    [
        (archive()[:1000], str(len(archive())), f"the answer ends after 1000 of {len(archive())} bytes"),
        (b"1000\r\nabc", "chunked", "IncompleteRead"),
        (b"x" * (vendor._MAX_SIZE + 10), "", "the answer is longer than 16000000 bytes"),
        (b"x" * 100, "100", "is not the expected three.js"),
    ],
    ids=["cut", "cut chunk", "endless", "another"],
)
def test_what_is_not_whole_is_not_kept(
    data: bytes, announced: str, reason: str, registry: type[Registry]
) -> None:
    registry.data, registry.announced = data, announced
    with pytest.raises(vendor.VendorError, match=reason) as error:
        vendor.fetch()
    assert "\n" not in str(error.value)
    assert not vendor.folder().exists()


def test_nobody_answers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("npm_config_registry", "http://127.0.0.1:9")
    with pytest.raises(vendor.VendorError, match="cannot be fetched from"):
        vendor.fetch()


@pytest.mark.usefixtures("registry")
def test_a_cache_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file where a folder should be")
    with pytest.raises(vendor.VendorError, match=r"cannot be kept in .*three-"):
        vendor.fetch()
