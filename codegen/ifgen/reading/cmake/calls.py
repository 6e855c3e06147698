"""The result of following a CMakeLists.txt: all that other rooms see of CMake."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ifgen.diagnostics import Source, Span
from ifgen.reading.cmake.values import Doubt


@dataclass(frozen=True, slots=True)
class Call:
    """A call of `rosidl_generate_interfaces`, with its files as they are passed, relative to `folder`.

    `checks_group` is true if rosidl requires the package to be in the group rosidl_interface_packages.
    """

    folder: Path
    files: tuple[str, ...]
    dependencies: tuple[str, ...]
    span: Span
    doubt: Doubt | None
    dependencies_are_known: bool
    checks_group: bool


@dataclass(frozen=True, slots=True)
class Followed:
    """The calls that were found in `sources`, the files that were read, and why there may be others."""

    calls: tuple[Call, ...]
    sources: tuple[Source, ...]
    unsure: Doubt | None
