"""The options `--system` of `ifgen check`, `graph` and `breaking`, and `--check` of `ifgen launch`."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from ifgen.command_kit import terminal
from ifgen.command_kit.system import SystemRequest
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.signals import sigterm_raises
from ifgen.writing import transaction

from ifgen_tools.graph.connections import Graph, of_endpoints
from ifgen_tools.ros_graph import Endpoint
from ifgen_tools.system import manifest
from ifgen_tools.system.build import Built, Request, build
from ifgen_tools.system.changes import LEVELS, Change, changes, diagnostic
from ifgen_tools.system.model import System
from ifgen_tools.system.rules import check as check_rules


def check(
    request: SystemRequest, format_: str = "text", strict: bool | None = None, quiet: bool = False
) -> int:
    """Look for what is wrong with a system before it starts, and print that; 1 if there is an error."""
    built = of_request(request)
    policy = settle(request.packages, None, request.include, strict=strict).policy
    diagnostics = policy.told(findings(built, complete=request.complete))
    code = terminal.print_findings(
        diagnostics, format_, "" if quiet else f"{in_words(built.system)}: no mistakes"
    )
    if request.lock and not code:
        _write(manifest.of_system(built.system))
    return code


def graph(request: SystemRequest) -> Graph:
    """The graph of a system, to be drawn."""
    built = of_request(request)
    if request.lock:
        _write(manifest.of_system(built.system))
    own = (end for end in built.system.endpoints if not end.is_of_framework)
    ends = (Endpoint(e.node, e.name, e.category, e.type_name, e.qos, e.type_hash) for e in own)
    return of_endpoints((node.name for node in built.system.nodes), ends)


def breaking(old: Path, new: Path, format_: str = "text", quiet: bool = False) -> int:
    """Compare two manifests, and say of each change what it breaks; 1 if one is major."""
    found = changes(manifest.read(old), manifest.read(new))
    if format_ != "text":
        return terminal.print_findings([diagnostic(each) for each in found], format_, "")
    if found:
        print("\n".join(map(str, found)))
    if not quiet:
        print(_verdict(found))
    return int(any(each.level == "major" for each in found))


def of_request(request: SystemRequest) -> Built:
    """The system that a command asks for. Raises InputError, ToolError."""
    return build(
        Request(
            launch_files=request.launch_files,
            arguments=dict(request.arguments),
            packages=request.packages,
            include=request.include,
            parameter_files=request.parameter_files,
            transport=request.transport,
            with_python=request.with_python,
        )
    )


def findings(built: Built, *, complete: bool = False) -> list[Diagnostic]:
    """The mistakes in the files of a system, and in what they are together."""
    return [*built.findings, *check_rules(built.system, complete=complete)]


def in_words(system: System) -> str:
    """A system in a few words."""
    names = {(end.name, end.category.folder) for end in system.endpoints if not end.is_of_framework}
    counts: Iterable[tuple[int, str]] = (
        (len(system.nodes), "node"),
        (len(names), "connection"),
        (len(system.open_ends), "open end"),
    )
    return ", ".join(terminal.counted(number, noun) for number, noun in counts if number)


def _verdict(found: Sequence[Change]) -> str:
    if not found:
        return "nothing changed"
    counts = {level: sum(each.level == level for each in found) for level in reversed(LEVELS)}
    listed = ", ".join(f"{number} {level}" for level, number in counts.items() if number)
    return f"{found[0].level}: {listed}"


def _write(content: manifest.Manifest) -> None:
    path = Path.cwd() / manifest.NAME
    with sigterm_raises():
        transaction.apply([(path, manifest.text(content).encode())], path.parent)
    print(f"wrote {shown_path(path)}", file=sys.stderr)
