"""Environments of Python for the other implementations, which cannot all share one."""

from __future__ import annotations

import subprocess
import sys
import venv
from collections.abc import Mapping
from pathlib import Path

from ifgen import resources

from tests.interop.bench.peers import Peer


class CannotInstall(Exception):
    """Pip cannot install an implementation; the text has its first error."""


def python_of(name: str, pythons: Mapping[str, str]) -> str:
    """The interpreter for an implementation: one that was named, one that `install` made, or our own."""
    if name in pythons:
        return pythons[name]
    made = _python(name)
    return str(made) if made.is_file() else sys.executable


def install(peer: Peer) -> Path:
    """Make an environment for an implementation, and return its folder. Raises CannotInstall."""
    folder = _folder(peer.name)
    venv.create(folder, clear=True, with_pip=True)
    words = [str(_python(peer.name)), "-m", "pip", "install", "--quiet", *peer.requirements]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        raise CannotInstall(f"{peer.name} could not be installed: {said[0] if said else done.stderr[-200:]}")
    return folder


def _folder(name: str) -> Path:
    return resources.cache_folder() / "interop" / name


def _python(name: str) -> Path:
    return _folder(name) / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
