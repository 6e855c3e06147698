"""From a planned file to its text, with the user's filters: the only place that fills templates in."""

from __future__ import annotations

import json
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import jinja2

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.definition.names import snake_case
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shorten
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.imports import gathered
from ifgen.reading.storage import read_limited
from ifgen.writing import cache as kept

if TYPE_CHECKING:
    from ifgen.generator_py.templates.parsed import Broken, TemplateLine


_MODULE = "ifgen_filters"


@dataclass(frozen=True, slots=True)
class Additions:
    """The additions of a file to the templates' language: filters, tests and global names."""

    filters: dict[str, Callable[..., Any]] = field(default_factory=dict[str, Callable[..., Any]])
    tests: dict[str, Callable[..., Any]] = field(default_factory=dict[str, Callable[..., Any]])
    names: dict[str, object] = field(default_factory=dict[str, object])


def load(path: Path, environment: jinja2.Environment) -> Additions:
    """Run the file. Its public functions are filters, `is_NAME` is the test NAME too, and CAPITALS are names.

    Raises InputError if the file fails, or names something as the environment does already.
    """
    try:
        text = read_limited(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        problem = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        message = f"the filters in {path} cannot be read: {problem}"
        raise InputError([Diagnostic("filters", message)]) from None
    module = ModuleType(_MODULE)
    module.__file__ = str(path)
    sys.modules[_MODULE] = module  # dataclasses look there for the module of a class
    try:
        # Not imported, for that leaves bytecode in the user's folder.
        exec(compile(text, str(path), "exec"), module.__dict__)
    except SyntaxError as error:
        raise _failure(path, error.lineno, str(error.msg)) from None
    except (Exception, SystemExit) as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        raise _failure(path, lines[-1] if lines else None, f"{type(error).__name__}: {error}") from error
    return _additions(module, path, environment)


def _additions(module: ModuleType, path: Path, environment: jinja2.Environment) -> Additions:
    found = Additions()
    for name, value in vars(module).items():
        if isfunction(value) and value.__module__ == _MODULE and not name.startswith("_"):
            found.filters[name] = value
            if name.startswith("is_"):
                found.tests[name.removeprefix("is_")] = value
        elif name.isupper() and not name.startswith("_"):
            found.names[name] = value
    kinds = (
        ("filter", found.filters, environment.filters),
        ("test", found.tests, environment.tests),
        ("name", found.names, environment.globals),
    )
    for kind, names, known in kinds:
        for name in names:
            if name in known:
                line = getattr(getattr(vars(module).get(name), "__code__", None), "co_firstlineno", None)
                raise _failure(path, line, f"there is a {kind} '{name}' already: choose another name")
    return found


def _failure(path: Path, line: int | None, text: str) -> InputError:
    return InputError(
        [Diagnostic("filters", "the filters for templates cannot be used", at_line(path, line or 1, text))]
    )


def explained(error: Exception, custom: Customization) -> InputError | None:
    """The error in one of the user's templates or filters while it ran; None if it was elsewhere."""
    own = [folder.absolute() for folder in (*custom.folders, custom.filters) if folder is not None]
    places: dict[Path, int] = {}
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if any(path.is_relative_to(folder) for folder in own):
            places.setdefault(path, frame.lineno or 1)
    if not places:
        return None
    (path, line), *callers = places.items()
    said = " ".join(str(error).split())
    label = at_line(path, line, f"{type(error).__name__}: {said}")
    used = tuple(at_line(caller, line, "used here") for caller, line in callers)
    what = "filter" if path == (custom.filters and custom.filters.absolute()) else "template"
    return InputError([Diagnostic("template-error", f"this {what} cannot be used", label, used)])


def at_line(path: Path, line: int, text: str) -> Label:
    """A label on a whole line of a file, without its indentation."""
    source = Source(path, read_limited(path).decode("utf-8", "replace"))
    start = sum(len(text) for text in source.text.splitlines(keepends=True)[: line - 1])
    shown = source.line(line)
    indent = len(shown) - len(shown.lstrip())
    return Label(Span(source, start + indent, start + len(shown)), text)


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
