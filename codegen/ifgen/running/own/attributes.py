"""Lets attributes of a module be each program's own: `sys.argv`, `sys.path`, `sys.stdout`.

The module gets a class with properties for a while, so what a program reads is its own plain list or file,
and what it assigns is seen by its own threads alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from types import ModuleType
from typing import Any

from ifgen.running.companion import current


class OwnAttributes:
    """Does so while it is entered. A program that has assigned nothing sees the process's value."""

    def __init__(self, module: ModuleType, *names: str) -> None:
        self._module = module
        self._kind = type(module)
        self._names = names
        self._values = {name: vars(module)[name] for name in names}

    def __enter__(self) -> OwnAttributes:
        members: dict[str, Any] = {name: _property(name) for name in self._names}
        members["__getattribute__"] = _get
        self._module.__class__ = type(self._kind.__name__, (self._kind,), members)
        return self

    def __exit__(self, *_: object) -> None:
        self._module.__class__ = self._kind
        vars(self._module).update(self._values)


def _get(module: ModuleType, name: str) -> Any:
    """Read an attribute as usual, properties first.

    Without a Python function for it CPython 3.14 reads the module's dictionary past them, once code is warm.
    """
    return ModuleType.__getattribute__(module, name)


def _property(name: str) -> property:
    def read(module: ModuleType) -> Any:
        companion = current()
        if companion is None:
            return vars(module)[name]
        return companion.attributes.get((module, name), vars(module)[name])

    def write(module: ModuleType, value: Any) -> None:
        companion = current()
        if companion is None:
            vars(module)[name] = value
        else:
            companion.attributes[module, name] = value

    return property(read, write)


class OwnStreams:
    """`sys.stdout` and its like, where `print` looks for them: that is not where attributes are read."""

    def __init__(self, sys_module: ModuleType, *names: str) -> None:
        self._sys = sys_module
        self._streams = {name: _Stream(sys_module, name) for name in names}

    def __enter__(self) -> OwnStreams:
        vars(self._sys).update(self._streams)
        return self

    def __exit__(self, *_: object) -> None:
        vars(self._sys).update({name: stream.real for name, stream in self._streams.items()})


class _Stream:
    """Stands for the current program's stream."""

    def __init__(self, sys_module: ModuleType, name: str) -> None:
        self.real = vars(sys_module)[name]
        self._key = sys_module, name

    def __getattr__(self, name: str) -> Any:
        companion = current()
        stream = self.real if companion is None else companion.attributes.get(self._key, self.real)
        return getattr(stream, name)


class WholeLines:
    """A stream of one program that shares it with others: its lines come as a whole."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._rest = ""

    def write(self, text: str) -> int:
        """Write the lines that are complete, and keep the rest."""
        lines, end, self._rest = (self._rest + text).rpartition("\n")
        if end:
            self._stream.write(lines + end)
            self._stream.flush()
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write texts."""
        self.write("".join(lines))

    def flush(self) -> None:
        """Write what was kept."""
        rest, self._rest = self._rest, ""
        if rest:
            self._stream.write(rest)
        self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
