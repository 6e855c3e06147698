"""Gives each program in company its own `__main__`, and its own modules from beside it.

Two programs may each have a `helper.py` in their folder. Both become `sys.modules["helper"]`, each under a
key that only the threads of its program find. So an import, pickle, dataclasses and inspect get the same
module as in a separate process.

What is found on the path that all have in common (the standard library, installed packages, PYTHONPATH, the
output folder) is one module for all, and so are generated packages wherever they are: rclpy uses them too.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import ExitStack
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any

from ifgen.reading import manifest
from ifgen.running.companion import Companion, current
from ifgen.running.exchange import exchanged

_import_system: Any = sys.modules["_frozen_importlib"]


_WITH_STATE = ("random",)
"""Modules of the standard library that each program has for itself: a seed is meant for one program."""


class Key(str):
    """The name of a module that only the threads of one program find; `owner` None: threads of none."""

    __slots__ = ("owner",)
    owner: Companion | None
    __hash__ = str.__hash__

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Key):
            return other.owner is self.owner and str.__eq__(self, other)
        return current() is self.owner and str.__eq__(self, other)

    def __ne__(self, other: object) -> bool:
        return not self == other


def _key(name: str, owner: Companion | None) -> Key:
    key = Key(name)
    key.owner = owner
    return key


class OwnModules:
    """Does so while it is entered; `add` each program before it runs."""

    def __init__(self) -> None:
        self._shared = frozenset(map(_absolute, sys.path))
        self._apart = {name: sys.modules[name] for name in ("__main__", *_WITH_STATE) if name in sys.modules}
        self._lock = _import_system._get_module_lock
        self._stack = ExitStack()

    def __enter__(self) -> OwnModules:
        self._stack.enter_context(exchanged((_import_system, "_get_module_lock", self._lock_here)))
        for name, module in self._apart.items():
            del sys.modules[name]
            sys.modules[_key(name, None)] = module
        # Before the finder of everything on sys.path, and after those of built-in modules.
        place = sys.meta_path.index(PathFinder) if PathFinder in sys.meta_path else len(sys.meta_path)
        sys.meta_path.insert(place, self)
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()
        sys.meta_path.remove(self)
        for key in [key for key in sys.modules if isinstance(key, Key)]:
            del sys.modules[key]
        sys.modules.update(self._apart)

    def add(self, companion: Companion) -> None:
        """Make room for its `__main__`."""
        companion.modules.add("__main__")
        sys.modules[_key("__main__", companion)] = ModuleType("__main__")

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a module that is to be the current program's own. Part of the protocol of sys.meta_path."""
        companion, name = current(), str(name)
        package = name.rpartition(".")[0]
        if companion is None or (package and package not in companion.modules):
            return None
        found = PathFinder.find_spec(name, path, target)
        if found is None or (not package and self._is_shared(found, companion)):
            return None
        companion.modules.add(name)
        # The import system files the module under the name in here.
        found.name = _key(name, companion)
        if found.loader is not None:
            _name_plainly(found.loader, name)
        return found

    def _lock_here(self, name: str) -> Any:
        """The locks to hold while a module runs. The `helper` of one program may wait for that of another."""
        companion = current()
        if companion is not None:
            place = Path(companion.program.folder, name.partition(".")[0])
            if place.is_dir() or place.with_suffix(".py").is_file():
                name = f"{name} of {id(companion)}"
        return self._lock(name)

    def _is_shared(self, found: ModuleSpec, companion: Companion) -> bool:
        if found.name in _WITH_STATE:
            return False
        places = [_absolute(place) for place in found.submodule_search_locations or [found.origin or ""]]
        if any((place / manifest.NAME).exists() for place in places):
            return True
        folders = {place.parent for place in places}
        return folders <= self._shared and Path(companion.program.folder) not in folders


def _name_plainly(loader: Any, name: str) -> None:
    """Let a module be called by its name as it runs: what it defines remembers that."""
    execute = loader.exec_module

    def exec_module(module: ModuleType) -> None:
        module.__name__ = name
        execute(module)

    loader.exec_module = exec_module


def _absolute(entry: str) -> Path:
    return Path(entry).absolute()
