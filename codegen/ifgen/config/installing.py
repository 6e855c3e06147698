"""How to install a missing package. The runtime knows, because it may be installed without this package."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ifgen import resources


def _installation() -> Any:
    # Found by name: the toolkit imports nothing of the runtime.
    return import_module("ifgen_runtime.installation")


def add_extra(extra: str) -> str:
    """The command that adds an extra, such as `ros`, to what is installed here."""
    command: str = _installation().add_extra(extra)
    return command


def add_native() -> str:
    """The command that adds the codec in C, which is the type support for real rclpy as well."""
    command: str = _installation().add_native()
    return command


def add_runtime() -> str:
    """The command that installs the runtime that belongs to this ifgen."""
    command: str = _installation().add_runtime()
    return command


def runtime() -> str:
    """The name of the distribution that generated packages need where they run."""
    name: str = _installation().RUNTIME
    return name


def version() -> str:
    """The version of all our distributions."""
    return resources.VERSION


def origin() -> str:
    """The origin of this installation of ifgen."""
    words: str = _installation().origin()
    return words
