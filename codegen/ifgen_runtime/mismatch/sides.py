"""Two endpoints whose definitions of one type differ, as values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ifgen_runtime.convert import to_dict
from ifgen_runtime.type_description import describe, sources


@dataclass(frozen=True, slots=True)
class Definition:
    """A definition of a type: its description (REP-2016), and the sources that are known.

    `document` has the keys `type_description` and `referenced_type_descriptions`. `sources` are (type name,
    `msg`, `srv`, `action`, `idl` or `implicit`, text).
    """

    document: dict[str, Any] = field(repr=False)
    sources: tuple[tuple[str, str, str], ...] = field(default=(), repr=False)


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two endpoints.

    `node` is the full name of its node. `role` is `publisher`, `subscription`, `service client`, `service
    server`, `action client` or `action server`. `type_hash` is `RIHS01_...`, or empty where it is unknown.
    """

    node: str
    role: str
    type_hash: str
    definition: Definition | None = None


@dataclass(frozen=True, slots=True)
class Mismatch:
    """Two endpoints that met on `name`, a topic, a service or an action, as their `kind` says.

    `mine` is an endpoint of this process. `policy` is its node's, after it was applied: a node that was to
    adapt and has no adapter refuses.
    """

    kind: str
    name: str
    type_name: str
    policy: str
    mine: Side
    theirs: Side


def definition_of(cls: type[Any]) -> Definition:
    """The definition that a class was generated from."""
    return Definition(describe(cls), tuple(sources(cls)))


def definition_from(response: Any) -> Definition:
    """The definition in a response of another node's `~/get_type_description`.

    It is what that node says: nobody has checked it yet. Raises ValueError, with the node's reason, if the
    node refused.
    """
    if not response.successful:
        raise ValueError(response.failure_reason or "the node does not say why")
    texts = ((known.type_name, known.encoding, known.raw_file_contents) for known in response.type_sources)
    return Definition(to_dict(response.type_description), tuple(texts))
