"""A Python file of the user's with filters for templates."""

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

from ifgen.diagnostics import Diagnostic, InputError
from ifgen.generator_py.templates.places import at_line
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
