"""The user's code in templates: a Python file of filters, and errors while templates or filters run."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

import jinja2

from ifgen.config.customization import Customization
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.reading.storage import read_limited

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
