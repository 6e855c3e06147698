"""Fetches three.js from the npm registry: `python -m humanoid.web.vendor`.

It is not part of the repository; whoever builds or runs the page has it fetched once, and checked against the
hash that is pinned here.
"""

from __future__ import annotations

import base64
import hashlib
import io
import os
import tarfile
import urllib.error
import urllib.request
from pathlib import Path

VERSION = "0.187.0"
INTEGRITY = "Qiu7R+Cmh8CstZsY1uJOSWnVlfo7ZtNLV7mF8Jltk3LB3AtDu9cRZlcnRKkAk8Y4z6KKw35z7Y7Urd7jWY8etA=="
FOLDER = Path(__file__).parent / "vendor"
_FILES = {
    "package/build/three.module.js": "three.module.js",
    "package/build/three.core.js": "three.core.js",
    "package/examples/jsm/controls/OrbitControls.js": "OrbitControls.js",
    "package/LICENSE": "three.LICENSE",
}
_REGISTRY = "https://registry.npmjs.org"
_TIMEOUT = 60.0


class VendorError(RuntimeError):
    """three.js could not be had; the text says why and what to do."""


def present() -> bool:
    """Whether the files are there, of the version that is pinned."""
    stamp = FOLDER / "version"
    return stamp.is_file() and stamp.read_text() == VERSION


def fetch() -> None:
    """Get the files if they are not there. Raises VendorError."""
    if present():
        return
    # npm's own variable, which it spells in small letters.
    registry = os.environ.get("npm_config_registry", _REGISTRY).rstrip("/")  # noqa: SIM112
    url = f"{registry}/three/-/three-{VERSION}.tgz"
    try:
        with urllib.request.urlopen(url, timeout=_TIMEOUT) as answer:
            data: bytes = answer.read()
    except (OSError, urllib.error.URLError) as error:
        raise VendorError(
            f"three.js cannot be fetched from {url} ({error}): the page needs it once; "
            "set npm_config_registry to a mirror, or watch without --web"
        ) from None
    if base64.b64encode(hashlib.sha512(data).digest()).decode() != INTEGRITY:
        raise VendorError(f"{url} is not the three.js {VERSION} that is expected: its SHA-512 differs")
    FOLDER.mkdir(exist_ok=True)
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        for inside, name in _FILES.items():
            member = archive.extractfile(inside)
            if member is None:
                raise VendorError(f"three.js {VERSION} has no {inside}")
            (FOLDER / name).write_bytes(member.read())
    (FOLDER / "version").write_text(VERSION)


if __name__ == "__main__":
    try:
        fetch()
    except VendorError as failure:
        raise SystemExit(f"error: {failure}") from None
