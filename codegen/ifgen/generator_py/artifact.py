"""A planned file, and a finished one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Artifact:
    """A file to be: where (inside the package's folder), from which template, with what in it.

    `variables` are what the template is given, by name; their types are in template_table.py.
    """

    path: str
    template: str
    variables: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class OutputFile:
    """A finished file; `path` is inside the folder of its package."""

    path: str
    text: str
