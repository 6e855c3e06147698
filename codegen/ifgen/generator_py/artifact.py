"""A planned file, and a finished one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Artifact:
    """A file to be: where (inside the package's folder), from which template, with what in it.

    `variables` are the variables of the template, by name; their types are in templates/table.py. A module of
    `own_package` has its import lines gathered at its top, those of that package last: its template writes
    them beside the text that needs them. None leaves lines where they are. The text of an output `is_output`:
    it is parsed, if that can be done, since nothing else vouches for it.
    """

    path: str
    template: str
    variables: Mapping[str, object]
    own_package: str | None = None
    is_output: bool = False


@dataclass(frozen=True, slots=True)
class OutputFile:
    """A finished file; `path` is inside the folder of its package."""

    path: str
    text: str
