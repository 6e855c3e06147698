"""A program as the command line names it: found before anything runs, then run as Python itself would."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import find_spec
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from ifgen.diagnostics import Diagnostic, UsageError


@dataclass(frozen=True, slots=True)
class Program:
    """A file or a module with its arguments.

    `words` are the arguments, `name` is the name in messages, and `folder` is the first place for imports.
    """

    words: tuple[str, ...]
    name: str
    folder: str

    def execute(self) -> None:
        """Run it as `__main__`. The caller sets sys.argv, sys.path and sys.modules["__main__"]."""
        sys.path.insert(0, self.folder)
        sys.argv = list(self.words)
        module, code = self._module() if self.words[0] == "-m" else self._file()
        vars(module)["__builtins__"] = sys.modules["builtins"]  # as the interpreter sets it
        sys.modules["__main__"] = module
        exec(code, vars(module))

    def _file(self) -> tuple[ModuleType, CodeType]:
        loader, code = _compile(self.words[0])
        module = ModuleType("__main__")
        vars(module).update(__file__=loader.path, __loader__=loader, __cached__=None)
        return module, code

    def _module(self) -> tuple[ModuleType, CodeType]:
        name = self.words[1]
        if parent := name.rpartition(".")[0]:
            importlib.import_module(parent)
        specification = find_spec(name)
        if specification is not None and specification.submodule_search_locations is not None:
            importlib.import_module(name)
            specification = find_spec(f"{name}.__main__")
        if specification is None:  # it was there a moment ago
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        specification.name = str(specification.name)
        code = _code(specification)
        module = ModuleType("__main__")
        vars(module).update(
            __file__=specification.origin,
            __loader__=specification.loader,
            __cached__=specification.cached,
            __package__=specification.parent,
            __spec__=specification,
        )
        sys.argv[:2] = [specification.origin or name]
        return module, code


def find(words: Sequence[str]) -> Program:
    """Find the program that these words name, without running anything of it.

    Raises UsageError if there is none, SyntaxError and what else a compiler has to say.
    """
    first = words[0]
    if first != "-m":
        file = Path(first)
        _compile(first)
        return Program(tuple(words), file.name, str(file.resolve().parent))
    name, folder = words[1], str(Path.cwd())
    specification = _look_for(name, folder)
    if specification is not None and specification.submodule_search_locations is not None:
        what = f"{name}.__main__"
        specification = _in_package(specification, what)
        if specification is None:
            message = f"the package '{name}' cannot be run: it has no module '__main__'"
            raise UsageError([Diagnostic("no-program", message, help="name one of its modules after `-m`")])
    if specification is None:
        advice = f"ifgen looked in {folder}, on PYTHONPATH and among the installed packages"
        raise UsageError([Diagnostic("no-program", f"there is no module '{name}'", help=advice)])
    _code(specification)
    return Program(tuple(words), name, folder)


def _compile(file: str) -> tuple[SourceFileLoader, CodeType]:
    # Since 3.9 a program finds itself by an absolute path, wherever it goes.
    path = os.path.join(Path.cwd(), file)  # noqa: PTH118 - a Path would drop the dots
    loader = SourceFileLoader("__main__", path)
    code: CodeType = loader.source_to_code(loader.get_data(path), path)
    return loader, code


def _look_for(name: str, folder: str) -> ModuleSpec | None:
    """The file of a module. The packages around it are not imported, if possible."""
    top, *inner = name.split(".")
    sys.path.insert(0, folder)
    try:
        if not all((top, *inner)):
            return None
        found = find_spec(top)
        for depth in range(len(inner)):
            if found is None:
                return None
            found = _in_package(found, ".".join([top, *inner[: depth + 1]]))
    finally:
        sys.path.remove(folder)
    return found


def _in_package(package: ModuleSpec, name: str) -> ModuleSpec | None:
    if package.submodule_search_locations is None:
        return None
    return PathFinder.find_spec(name, list(package.submodule_search_locations))


def _code(specification: ModuleSpec) -> CodeType:
    loader: Any = specification.loader
    name = specification.name
    code: object = loader.get_code(name) if hasattr(loader, "get_code") else None
    if not isinstance(code, CodeType):
        message = f"the module '{name}' is not Python, so it cannot be run"
        raise UsageError([Diagnostic("no-program", message)])
    return code
