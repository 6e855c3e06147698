"""From a planned file to its text: the only place that uses jinja2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2
import platformdirs

from ifgen import resources
from ifgen.generator_py import overrides
from ifgen.generator_py.artifact import Artifact


@dataclass(frozen=True, slots=True)
class OutputFile:
    """A finished file; `path` is inside the folder of its package."""

    path: str
    text: str


def render(artifact: Artifact, templates: Sequence[Path] = ()) -> OutputFile:
    """The text of a file. Templates in these folders replace ours of the same name; later folders win.

    They can build on the one that they replace: `{% extends "ifgen/message_package/operators.j2" %}`.
    Raises InterfaceError for what is wrong with them.
    """
    try:
        template = _environment(tuple(templates)).get_template(artifact.template)
        return OutputFile(artifact.path, template.render(artifact.variables))
    except Exception as error:
        explained = overrides.explained(error, templates)
        if explained is None:
            raise
        raise explained from error


@cache
def _environment(templates: tuple[Path, ...]) -> jinja2.Environment:
    ours = jinja2.FileSystemLoader(resources.templates())
    replacements = map(jinja2.FileSystemLoader, reversed(templates))
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([*replacements, ours, jinja2.PrefixLoader({"ifgen": ours})]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=bool(templates),  # `ifgen generate --watch` goes on after they change
        bytecode_cache=_bytecode_cache(),
    )
    overrides.check_overrides(environment, templates)
    return environment


def _bytecode_cache() -> jinja2.BytecodeCache | None:
    """Compiled templates, kept between runs; compiling takes longer than rendering a package."""
    folder = platformdirs.user_cache_path("ifgen") / "templates"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return jinja2.FileSystemBytecodeCache(str(folder))
    except OSError:
        return None
