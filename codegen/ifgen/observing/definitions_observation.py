"""The file in which `ifgen.observing.definitions_observer` passes its observations to the command."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ifgen.observing.definitions_seen import User


@dataclass(frozen=True, slots=True)
class Definition:
    """A definition that a node sent, which nobody has checked: a type description, and sources of types."""

    node: str
    document: Mapping[str, Any]
    sources: Sequence[tuple[str, str, str]]


@dataclass(frozen=True, slots=True)
class Seen:
    """All nodes, what they use, and by type hash the definitions that they sent."""

    nodes: tuple[str, ...]
    users: tuple[User, ...]
    definitions: Mapping[str, Definition]


def command(file: Path, nodes: int) -> list[str]:
    """The arguments that run the observer by `ifgen.running.run`; it waits for the given number of nodes."""
    return ["-m", "ifgen.observing.definitions_observer", str(file), str(nodes)]


def write(file: Path, seen: Seen) -> None:
    """Write down what was seen."""
    file.write_text(json.dumps(asdict(seen)), encoding="utf-8")


def read(file: Path) -> Seen | None:
    """The observations in the file; None if the observer ended before it wrote them."""
    if not file.is_file() or not file.stat().st_size:
        return None
    found = json.loads(file.read_text(encoding="utf-8"))
    return Seen(
        tuple(found["nodes"]),
        tuple(User(**user) for user in found["users"]),
        {type_hash: Definition(**each) for type_hash, each in found["definitions"].items()},
    )
