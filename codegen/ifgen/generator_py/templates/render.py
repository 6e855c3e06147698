"""From a planned file to its text: the only place that fills templates in."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jinja2

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.definition.names import snake_case
from ifgen.diagnostics import Diagnostic, InputError, shorten
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.imports import gathered
from ifgen.generator_py.templates.filters import at_line, explained, load
from ifgen.writing import cache as kept

if TYPE_CHECKING:
    from ifgen.generator_py.templates.parsed import Broken, TemplateLine


class Templates:
    """ifgen's templates, with what a user put in their place or added to them.

    Those can build on the ones that they replace: `{% extends "ifgen/message_package/operators.j2" %}`.
    """

    def __init__(self, custom: Customization | None = None) -> None:
        """Raises InputError for templates and filters that cannot be used."""
        self._custom = custom or Customization()
        self._environment = _environment_for(self._custom)
        if self._custom.folders or self._custom.outputs:
            from ifgen.generator_py.templates import checking  # of use only where templates are the user's

            found = checking.problems(self._environment, self._custom)
            wrong = [problem for problem in found if problem.severity == "error"]
            if wrong:
                raise InputError(wrong)

    def render(self, artifact: Artifact) -> OutputFile:
        """The text of a file. Raises InputError for what is wrong with a template of the user's."""
        try:
            template = self._environment.get_template(artifact.template)
            text = template.render(artifact.variables)
        except Exception as error:
            failure = explained(error, self._custom)
            if failure is None:
                raise
            raise failure from error
        if artifact.own_package is not None:
            text = gathered(text, artifact.own_package)
        if not text.isascii():
            self._check_encoding(text, artifact)
        if artifact.is_output:
            self._check_syntax(text, artifact)
        return OutputFile(artifact.path, text)

    def _check_syntax(self, text: str, artifact: Artifact) -> None:
        from ifgen.generator_py.templates import parsed  # few runs have outputs

        if found := parsed.broken(artifact.path, text):
            place = parsed.template_line(
                self._environment, artifact.template, artifact.variables, text, found.line
            )
            raise InputError([self._broken(artifact, text, found, place)])

    def _broken(self, artifact: Artifact, text: str, found: Broken, place: TemplateLine | None) -> Diagnostic:
        name, line = place or (artifact.template, 1)
        path = next((p for folder in reversed(self._custom.folders) if (p := folder / name).is_file()), None)
        shown = text.splitlines()[found.line - 1 : found.line]
        return Diagnostic(
            "broken-output",
            f"template {name} makes a broken file: {artifact.path}:{found.line}: {found.reason}",
            None if path is None else at_line(path, line, "from here" if place else "from this template"),
            help=f"the line in the file is `{shorten(shown[0].strip())}`" if shown else None,
        )

    @staticmethod
    def _check_encoding(text: str, artifact: Artifact) -> None:
        try:
            text.encode()
        except UnicodeEncodeError as error:
            message = f"{artifact.path} cannot be written: {text[error.start]!r} is not a character"
            advice = f"look at template {artifact.template} and the filters that it uses"
            raise InputError([Diagnostic("template-error", message, help=advice)]) from None


def look_for_problems(custom: Customization) -> list[Diagnostic]:
    """All mistakes that a check of templates finds, warnings included. Nothing is rendered."""
    from ifgen.generator_py.templates import checking  # of use only where there are templates of the user's

    try:
        environment = _environment_for(custom)
    except InputError as error:
        return list(error.diagnostics)
    return checking.problems(environment, custom)


def _environment_for(custom: Customization) -> jinja2.Environment:
    environment = _environment(tuple(folder.absolute() for folder in custom.folders), custom.behind_name)
    if custom.filters is None:
        return environment
    additions = load(custom.filters.absolute(), environment)
    # Results of filters must not get into the compiled templates, which are kept.
    environment = environment.overlay(optimized=False)
    language: Any = environment  # its tables are typed as narrowly as what jinja2 puts in
    language.filters = {**language.filters, **additions.filters}
    language.tests = {**language.tests, **additions.tests}
    language.globals = {**language.globals, **additions.names}
    return environment


@cache
def _environment(folders: tuple[Path, ...], behind_name: str | None) -> jinja2.Environment:
    ours = jinja2.FileSystemLoader(resources.templates())
    originals: dict[str, jinja2.BaseLoader] = {"ifgen": ours}
    if behind_name is not None:
        originals[behind_name] = jinja2.FileSystemLoader(folders[0])
    replacements = map(jinja2.FileSystemLoader, reversed(folders))
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([*replacements, ours, jinja2.PrefixLoader(originals)]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=bool(folders),  # `ifgen generate --watch` goes on after they change
        bytecode_cache=_bytecode_cache(),
    )
    environment.filters["snake"] = snake_case
    environment.policies["json.dumps_function"] = _json
    return environment


def _json(value: object, **options: Any) -> str:
    from ifgen.model import plain  # a room that only outputs need

    return json.dumps(value, default=plain, **options)


def _bytecode_cache() -> jinja2.BytecodeCache | None:
    """Compiled templates, kept between runs; compiling takes longer than rendering a package."""
    try:
        return jinja2.FileSystemBytecodeCache(str(kept.folder("templates")))
    except OSError:
        return None
