"""`ifgen doctor --graph`: which nodes of a running system have different definitions of a type."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.evolution.explaining.definitions import Installed, Known, of_document, of_sources
from ifgen.evolution.explaining.explanation import adapt_command, differences, short

from ifgen_tools import discovery
from ifgen_tools.doctor.definitions import (
    Disagreement,
    User,
    Version,
    descriptions,
    disagreements,
    users,
    without_hash,
)
from ifgen_tools.ros_graph import service_parts

if TYPE_CHECKING:
    from ifgen.dynamic import TypeDescription

    from ifgen_tools.session import Session

_PATIENCE: Final = 10.0
"""Seconds to look for definitions that are installed: somebody waits for the command."""

_NODES: Final = 5
"""Nodes that are named for one definition."""

_FAR: Final = 1_000
"""The place of a definition that is not installed."""


@dataclass(frozen=True, slots=True)
class Seen:
    """All nodes that are not hidden, what they use, and by type hash the definitions that they sent."""

    nodes: tuple[str, ...]
    users: tuple[User, ...]
    definitions: Mapping[str, TypeDescription]


def look(session: Session) -> Seen:
    """Look what nodes use, and ask for definitions that differ. Raises UsageError if no node is there."""
    node = session.node
    view = session.graph()
    nodes = view.visible().nodes
    if not nodes:
        advice = "name a program, such as `--run talker.py`"
        raise UsageError([Diagnostic("no-node", "no node is running", help=advice)])
    is_local = session.transport == "local"
    hashes = discovery.service_hashes(session.context.get_domain_id()) if is_local else {}
    found = users(view, service_parts(node), hashes)
    return Seen(nodes, found, descriptions(node, disagreements(found)))


def findings(seen: Seen, include: Sequence[Path]) -> Iterator[Diagnostic]:
    """The disagreements, each followed by its differences, and a warning about nodes that do not say."""
    finder = _Finder(seen, Installed(_PATIENCE, include))
    for disagreement in disagreements(seen.users):
        yield from finder.findings(disagreement)
    if nodes := without_hash(seen.users):
        message = f"the definitions of {_listed(nodes)} are not known"
        help = "nodes before ROS 2 Iron have no type hashes: nobody can tell whether their definitions differ"
        warning = Diagnostic("no-type-hash", message, help=help, severity="warning")
        if not settle().policy.silences(warning):
            yield warning


class _Finder:
    """Finds what differs between definitions, and says it once."""

    def __init__(self, seen: Seen, installed: Installed) -> None:
        self._seen = seen
        self._installed = installed
        self._told: set[tuple[str | None, str | None]] = set()

    def findings(self, disagreement: Disagreement) -> Iterator[Diagnostic]:
        """A disagreement, and what differs."""
        known = {version: self._known(version) for version in disagreement.versions}
        ours = _ours(known, disagreement)
        helps: list[str] = []
        changes: list[Diagnostic] = []
        for version, (theirs, _) in known.items():
            pair = version.type_hash, ours.type_hash
            if version == ours or len(disagreement.type_names) > 1 or pair in self._told:
                continue
            self._told.add(pair)
            mine = known[ours][0]
            if theirs is None or mine is None:
                helps.append(_unknown(version if theirs is None else ours))
                continue
            found = differences(theirs, mine, self._installed)
            changes += found.changes
            helps += [found.remark] if found.remark else []
        helps.append(_advice(disagreement, ours))
        yield Diagnostic("type-mismatch", _message(disagreement), help="\n".join(helps))
        yield from changes

    def _known(self, version: Version) -> tuple[Known | None, int]:
        """The definition of a version, and how far it is from being the project's."""
        type_name, type_hash = version
        if type_hash is None:
            return None, _FAR
        installed = self._installed.definition(type_name, type_hash)
        if installed is not None:
            return installed, installed.place
        if (sent := self._seen.definitions.get(type_hash)) is None:
            return None, _FAR
        definition = {"document": sent.document, "sources": sent.sources}
        side: dict[str, Any] = {"type_hash": type_hash, "definition": definition}
        return of_sources(side, type_name, sent.node) or of_document(side), _FAR


def _ours(known: Mapping[Version, tuple[Known | None, int]], disagreement: Disagreement) -> Version:
    """The version that others are compared with: the project's, else that of most nodes, else of readers."""
    users = disagreement.versions
    return min(reversed([*known]), key=lambda version: (known[version][1], -len(users[version])))


def _unknown(version: Version) -> str:
    type_hash = f" {short(version.type_hash)}..." if version.type_hash else ""
    return (
        f"what differs is unknown: no node sent the definition{type_hash}, and it is not installed. To see "
        "it, name the folder that has it with -I"
    )


def _advice(disagreement: Disagreement, ours: Version) -> str:
    if len(disagreement.type_names) > 1:
        return "rename one of them, or use one type in all nodes"
    advice = "use one definition in all nodes"
    hashes = [v.type_hash for v in disagreement.versions if v != ours and v.type_hash]
    commands = [adapt_command(disagreement.kind, ours.type_name, each) for each in hashes]
    told = [command for command in commands if command]
    return "\n".join([f"{advice}, or convert with an adapter:", *told]) if told else advice


def _message(disagreement: Disagreement) -> str:
    """The types or definitions, with a line for the nodes that have each."""
    versions, names = disagreement.versions, disagreement.type_names
    if len(names) > 1:
        what = f"has {len(names)} types"
        rows = [(version.type_name, users) for version, users in versions.items()]
    else:
        what = f"has {len(versions)} definitions of {next(iter(versions)).type_name}"
        rows = [(f"{short(version.type_hash or '')}...", users) for version, users in versions.items()]
    lines = (f"  {version}  {_listed([_end(user) for user in users])}" for version, users in rows)
    return "\n".join((f"{disagreement.kind} '{disagreement.name}' {what}", *lines))


def _end(user: User) -> str:
    return f"{user.node} ({user.role})"


def _listed(words: Sequence[str]) -> str:
    more = [f"{len(words) - _NODES} more"] if len(words) > _NODES else []
    return ", ".join([*words[:_NODES], *more])
