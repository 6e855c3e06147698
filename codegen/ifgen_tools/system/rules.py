"""The rules of systems: one table, and what it finds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final

from ifgen.config import suppressions
from ifgen.diagnostics import Diagnostic, Source

from ifgen_tools.system import connections, settings, starting
from ifgen_tools.system.model import System
from ifgen_tools.system.view import View

RULES: Final[Sequence[Callable[[View], Iterable[Diagnostic]]]] = (
    starting.programs,
    starting.same_nodes,
    starting.unused_remaps,
    starting.remap_kinds,
    connections.types,
    connections.qos,
    connections.servers,
    connections.near_names,
    connections.namespaces,
    connections.required,
    connections.rates,
    connections.writers,
    connections.meanings,
    connections.duplicates,
    settings.unknown,
    settings.wrong,
    settings.missing,
    settings.for_nobody,
    settings.read_only,
    starting.lifecycles,
    starting.sim_time,
    starting.frames,
    starting.recordings,
)
"""Each looks at the whole system. Their names in findings are in docs/rules.md."""

OF_RUNNING: Final[Sequence[Callable[[View], Iterable[Diagnostic]]]] = (
    connections.qos,
    connections.servers,
    connections.near_names,
    connections.namespaces,
    connections.writers,
)
"""Those that a look at running nodes can tell. Doctor compares types and definitions itself."""


def check_running(system: System) -> list[Diagnostic]:
    """Everything that is wrong with the connections of nodes that run."""
    view = View(system)
    return list(dict.fromkeys(diagnostic for rule in OF_RUNNING for diagnostic in rule(view)))


def check(system: System, *, complete: bool = False) -> list[Diagnostic]:
    """Everything that is wrong with a system, errors first.

    With `complete` all nodes must be described, and all they need be there. Comments `ifgen: ignore[RULE]` in
    launch files and documents silence warnings.
    """
    view = View(system, complete)
    found = list(dict.fromkeys(diagnostic for rule in RULES for diagnostic in rule(view)))
    return sorted(_without_silenced(found), key=lambda diagnostic: diagnostic.severity != "error")


def _without_silenced(found: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    of_file: dict[Source | None, list[Diagnostic]] = {}
    for diagnostic in found:
        source = diagnostic.primary.span.source if diagnostic.primary else None
        of_file.setdefault(source, []).append(diagnostic)
    for source, diagnostics in of_file.items():
        yield from (
            diagnostics if source is None else suppressions.by_comments(source, diagnostics, complete=False)
        )
