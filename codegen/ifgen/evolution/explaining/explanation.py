"""Explains a mismatch: two endpoints that met, and whose definitions of a type differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Final

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.evolution.compare import between
from ifgen.evolution.edit_diagnostics import diagnostic
from ifgen.evolution.edits import Category
from ifgen.evolution.explaining.definitions import Installed, Known, of_document, of_sources

_MOST_VALUES: Final = 20_000
"""Values in a message, those of nested messages included: more would take too long to compare."""

_MOST_CHANGES: Final = 1_000

TOO_LARGE: Final = "the definitions are too large to compare while programs run"


@dataclass(frozen=True, slots=True)
class Differences:
    """The changes between two definitions that change the hash, and what to say besides."""

    changes: tuple[Diagnostic, ...] = ()
    remark: str = ""


def differences(old: Known, new: Known, installed: Installed) -> Differences:
    """The differences from `old` to `new`, with places in files where these can be found."""
    if not isinstance(old.described, type(new.described)):
        return Differences(remark=f"one is a {_kind(old.described)}, the other a {_kind(new.described)}")
    if any(_is_large(known.described, known.registry) for known in (old, new)):
        return Differences(remark=TOO_LARGE)
    sides = old.described, new.described, old.registry, new.registry
    every = islice(map(diagnostic, between(*sides, with_constants=False)), _MOST_CHANGES)
    found = [change for change in every if change is not None]
    changes = [change for change in found if Category.HASH in change.breaks]
    located = _Located(installed)
    if changes:
        return Differences(tuple(map(located.diagnostic, changes)))
    what = "only in defaults, which change no hash" if found else "in nothing that their fields show"
    return Differences(remark=f"the two definitions differ {what}")


def _kind(described: Interface) -> str:
    return type(described).__name__.lower()


class _Located:
    """Diagnostics with the paths of files: what was compared are texts, wherever they came from."""

    def __init__(self, installed: Installed) -> None:
        self._installed = installed
        self._sources: dict[Source, Source] = {}

    def diagnostic(self, change: Diagnostic) -> Diagnostic:
        """The same diagnostic, with these paths for all places of this side."""
        primary = self._label(change.primary) if change.primary is not None else None
        return replace(change, primary=primary, secondary=tuple(map(self._label, change.secondary)))

    def _label(self, label: Label) -> Label:
        source = label.span.source
        if source.revision is not None or source.path.is_absolute():
            return label
        if source not in self._sources:
            self._sources[source] = self._installed.located(source)
        return Label(Span(self._sources[source], label.span.start, label.span.end), label.text)


def _is_large(described: Interface, registry: Registry) -> bool:
    """Whether the messages of a type hold more values than can be compared in a moment."""
    sizes: dict[str, int] = {}

    def size(message: Message) -> int:
        name = message.type_name
        if name not in sizes:
            nested = [registry.message(type_.type_name) for _, type_ in references(message)]
            sizes[name] = len(message.fields) + sum(map(size, nested))
        return sizes[name]

    parts = (described,) if isinstance(described, Message) else described.messages
    return sum(map(size, parts)) > _MOST_VALUES


_PATIENCE: Final = 0.5
"""Seconds for a search of what is installed: a node waits meanwhile."""

_SHOWN: Final = 5
_NEVER_SENT: Final = ("_Request", "_Response")
"""The ends of types that nodes describe by the hash of a whole service, which the graph does not tell."""

_DIGITS: Final = len("RIHS01_") + 16


@dataclass(frozen=True, slots=True)
class Explanation:
    """The parts of a warning: who, what differs, and what to do.

    `changes` are the differences from the other definition to ours, `left_out` how many more there are.
    `command` is what writes an adapter, if there can be one, and `converts` the node that is to use it: None
    for ours.
    """

    head: str
    changes: tuple[Diagnostic, ...]
    left_out: int
    remarks: tuple[str, ...]
    command: str | None
    converts: str | None = None


def explained(mismatch: Mapping[str, Any]) -> Explanation:
    """The explanation of a mismatch, a `Mismatch` of the runtime as a dictionary.

    What its definitions say is not believed before it fits their hashes.
    """
    mine, theirs = mismatch["mine"], mismatch["theirs"]
    installed = Installed(_PATIENCE)
    type_name = mismatch["type_name"]
    old = (
        of_sources(theirs, type_name, theirs["node"])
        or of_document(theirs)
        or installed.definition(type_name, theirs["type_hash"])
    )
    new = (
        of_sources(mine, type_name, None)
        or installed.definition(type_name, mine["type_hash"])
        or of_document(mine)
    )
    found = differences(old, new, installed) if old and new else Differences()
    remarks = [_unknown(side, type_name) for side, known in ((theirs, old), (mine, new)) if known is None]
    remarks += filter(None, [found.remark])
    keeps_bytes = bool(found.changes) and all(Category.WIRE not in change.breaks for change in found.changes)
    remarks.append(_what_happens(mismatch, keeps_bytes=keeps_bytes))
    shown, left_out = found.changes[:_SHOWN], len(found.changes[_SHOWN:])
    # On a topic, whoever receives has the adapter, and it is from the version of the publisher.
    publishes = mine["role"] == "publisher"
    command = adapt_command(mismatch["kind"], type_name, (mine if publishes else theirs)["type_hash"])
    return Explanation(
        head(mismatch),
        shown,
        left_out,
        tuple(remarks),
        None if mismatch["policy"] == "adapt" and not publishes else command,
        theirs["node"] if publishes else None,
    )


def head(mismatch: Mapping[str, Any]) -> str:
    """The sentence that says who met whom, on what, with the hashes of both."""
    mine, theirs = mismatch["mine"], mismatch["theirs"]
    return (
        f"{mismatch['kind']} '{mismatch['name']}': {theirs['node']} ({theirs['role']}) has another "
        f"definition of {mismatch['type_name']} than {mine['node']} ({mine['role']}): "
        f"{short(theirs['type_hash'])}..., not {short(mine['type_hash'])}..."
    )


def short(type_hash: str) -> str:
    """As much of a hash as tells it from others."""
    return type_hash[:_DIGITS]


def _unknown(side: Mapping[str, Any], type_name: str) -> str:
    """Why a definition is not known, and how to get it."""
    if side["definition"]:
        said = f"{side['node']} says what does not fit its hash"
    elif type_name.endswith(_NEVER_SENT):
        said = "nodes cannot be asked for one part of a service"
    else:
        said = f"{side['node']} did not send its definition"
    return (
        f"what differs is unknown: {said}, and none with this hash is installed. To see it, "
        "name the folder that has it in `include` of [tool.ifgen], or put the package that was generated "
        "from it on PYTHONPATH"
    )


def _what_happens(mismatch: Mapping[str, Any], *, keeps_bytes: bool) -> str:
    """The sentence that says what is done with messages."""
    mine, theirs = mismatch["mine"]["node"], mismatch["theirs"]["node"]
    if mismatch["mine"]["role"] == "publisher":
        return f"what becomes of the messages is for {theirs} to decide, by its on_type_mismatch"
    what = "messages" if mismatch["kind"] == "topic" else "requests and responses"
    match mismatch["policy"]:
        case "adapt":
            how = f"an adapter converts {what} between the two"
        case "refuse" if mismatch["mine"]["role"] == "subscription":
            how = f"nothing from '{mismatch['name']}' reaches {mine} while {theirs} publishes there"
        case "refuse":
            how = f"no {what} pass between the two"
        case _:
            result = "their bytes mean the same" if keeps_bytes else "may be garbage"
            how = f"{what} still flow as far as ROS lets them, and {result}"
    return f"on_type_mismatch is {mismatch['policy']}: {how}"


def adapt_command(kind: str, type_name: str, type_hash: str) -> str | None:
    """The command that writes an adapter from a version; None if the hash is of a part that ROS derives."""
    if kind == "service":
        type_name = type_name.removesuffix("_Request").removesuffix("_Response")
    if kind == "action" and "_" in type_name.rpartition("/")[2]:
        return None
    return f"ifgen adapt {type_name} --from {short(type_hash)}"
