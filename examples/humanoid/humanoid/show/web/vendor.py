"""Fetches three.js from the npm registry: `python -m humanoid.show.web.vendor`.

It is not part of the repository. It is fetched when the page first runs, and checked against the hash that is
pinned here.
"""

from __future__ import annotations

import base64
import hashlib
import http.client
import io
import os
import tarfile
import tempfile
import urllib.request
from pathlib import Path

import platformdirs

VERSION = "0.187.0"
INTEGRITY = "Qiu7R+Cmh8CstZsY1uJOSWnVlfo7ZtNLV7mF8Jltk3LB3AtDu9cRZlcnRKkAk8Y4z6KKw35z7Y7Urd7jWY8etA=="
_FILES = {
    "package/build/three.module.js": "three.module.js",
    "package/build/three.core.js": "three.core.js",
    "package/examples/jsm/controls/OrbitControls.js": "OrbitControls.js",
    "package/LICENSE": "three.LICENSE",
}
_REGISTRY = "https://registry.npmjs.org"
_TIMEOUT = 60.0  # [s] of silence
_MAX_SIZE = 16_000_000  # [bytes]; the package has 4.8 million


class VendorError(RuntimeError):
    """three.js could not be fetched; the text says why and what to do."""


def folder() -> Path:
    """The folder of the files: in the user's cache, because an installation may be read-only."""
    return platformdirs.user_cache_path("ifgen") / f"three-{VERSION}"


def present() -> bool:
    """Whether the files of the pinned version are there."""
    return folder().is_dir()


def fetch() -> None:
    """Fetch the files if they are missing. Raises VendorError."""
    if present():
        return
    # npm's own variable, which is in lower case.
    registry = os.environ.get("npm_config_registry", _REGISTRY).rstrip("/")  # noqa: SIM112
    url = f"{registry}/three/-/three-{VERSION}.tgz"
    try:
        data = _download(url)
    except (OSError, ValueError, http.client.HTTPException) as error:
        raise VendorError(
            f"three.js cannot be fetched from {url} ({error or type(error).__name__}): the page needs it "
            "once; set npm_config_registry to a mirror, or watch without --web"
        ) from None
    if base64.b64encode(hashlib.sha512(data).digest()).decode() != INTEGRITY:
        raise VendorError(f"{url} is not the expected three.js {VERSION}: its SHA-512 differs")
    try:
        _unpack(data)
    except OSError as error:
        raise VendorError(f"three.js cannot be kept in {folder()}: {error.strerror or error}") from None


def _download(url: str) -> bytes:
    with urllib.request.urlopen(url, timeout=_TIMEOUT) as answer:
        data: bytes = answer.read(_MAX_SIZE + 1)
    if len(data) > _MAX_SIZE:
        raise ValueError(f"the answer is longer than {_MAX_SIZE} bytes")
    # http.client does not report a short body if a length was passed to read().
    announced = answer.headers.get("Content-Length", "")
    if announced.isdigit() and len(data) < int(announced):
        raise ValueError(f"the answer ends after {len(data)} of {announced} bytes")
    return data


def _unpack(data: bytes) -> None:
    """Unpack all files or none: no other process sees a partial folder, and the first of two wins."""
    folder().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder().parent, prefix=".three-") as temporary:
        made = Path(temporary) / "three"
        made.mkdir()
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            for inside, name in _FILES.items():
                member = archive.extractfile(inside)
                if member is None:
                    raise VendorError(f"three.js {VERSION} has no {inside}")
                (made / name).write_bytes(member.read())
        try:
            made.rename(folder())
        except OSError:
            if not present():
                raise


if __name__ == "__main__":
    try:
        fetch()
    except VendorError as failure:
        raise SystemExit(f"error: {failure}") from None
