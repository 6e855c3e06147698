"""Resolvers of references to documents beyond `local://` and `nodl://`, as nodl_schema has them.

A program registers one for its process; a package offers one to every command by an entry point of the group
`ifgen.nodl_resolvers`, which names a function without arguments that returns it.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final, Protocol, runtime_checkable

GROUP: Final = "ifgen.nodl_resolvers"
"""The group of entry points."""


@runtime_checkable
class Resolver(Protocol):
    """Knows a form of references, and the files that they lead to."""

    def handles(self, ref: str) -> bool:
        """Whether it knows a reference's form."""
        ...

    def resolve(self, ref: str, origin: Path) -> Path:
        """The file that a reference leads to, in the document `origin`. Raises any error if there is none."""
        ...


_registered: list[Resolver] = []


def register_resolver(resolver: Resolver) -> Resolver:
    """Register a resolver until the process ends. It comes before earlier ones, and before those of ifgen.

    Raises TypeError for an object that is none.
    """
    if not isinstance(resolver, Resolver):  # pyright: ignore[reportUnnecessaryIsInstance] - no typed caller
        raise TypeError(f"{resolver!r} is not a resolver: it needs the methods `handles` and `resolve`")
    _registered.append(resolver)
    return resolver


def unregister_resolver(resolver: Resolver) -> None:
    """Remove the last registration of a resolver. Raises LookupError if it has none."""
    for place in reversed(range(len(_registered))):
        if _registered[place] is resolver:
            del _registered[place]
            return
    raise LookupError(f"{resolver!r} is not registered")


@contextmanager
def resolver_registered(resolver: Resolver) -> Generator[Resolver]:
    """Register a resolver for a `with` block."""
    register_resolver(resolver)
    try:
        yield resolver
    finally:
        unregister_resolver(resolver)


def registered_for(reference: str) -> Resolver | None:
    """The newest resolver that a program registered for such references."""
    return _first(reversed(_registered), reference)


def installed_for(reference: str) -> Resolver | None:
    """A resolver for such references that an installed package offers. Raises what importing it raises."""
    return _first(iter(_installed()), reference)


def _first(resolvers: Iterator[Resolver], reference: str) -> Resolver | None:
    return next((each for each in resolvers if each.handles(reference)), None)


@cache
def _installed() -> tuple[Resolver, ...]:
    """Look at installed packages once, and only where a reference has an unknown scheme: that takes long."""
    return tuple(found.load()() for found in entry_points(group=GROUP))
