"""Two endpoints whose definitions of one type differ, as values, and the report about them.

Each transport makes a `Mismatch` of a pair that met, and reports it once: to the listener, if there is one,
and to the user by an explanation. With the toolkit that names the fields that differ, without it the hashes.
"""

from __future__ import annotations

import _thread
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import asdict, dataclass, field
from enum import Enum, auto
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

from ifgen_runtime.type_description import describe, sources

if TYPE_CHECKING:
    from collections.abc import Callable


ValueT = TypeVar("ValueT")

WARNINGS: Final = 10
"""The warnings about one topic, service or action."""

NAMES: Final = 256
"""The topics, services and actions whose warnings are counted one by one."""

_MOST: Final = 4096


class Lru(Generic[ValueT]):
    """Values by keys, for any thread. What nobody has asked for longest is forgotten."""

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, ValueT] = OrderedDict()
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def get(self, key: Hashable) -> ValueT | None:
        """The value of a key; None if there is none, or no longer."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def set(self, key: Hashable, value: ValueT) -> None:
        """Keep a value."""
        with self._lock:
            self._values[key] = value
            self._values.move_to_end(key)
            if len(self._values) > self._most:
                self._values.popitem(last=False)

    def pop(self, key: Hashable) -> ValueT | None:
        """Forget the value of a key, and return it."""
        with self._lock:
            return self._values.pop(key, None)


class SeenSet:
    """Keys that have been seen, for one thread."""

    def __init__(self) -> None:
        self._keys: Lru[bool] = Lru()

    def add(self, key: Hashable) -> bool:
        """Add a key; returns whether it is new."""
        is_new = self._keys.get(key) is None
        self._keys.set(key, True)
        return is_new


class Say(Enum):
    """The words for one more pair of endpoints."""

    ALL = auto()
    NO_MORE = auto()
    """This once: that no more is said about this name."""
    NOTHING = auto()


class WarningLimit:
    """Counts the warnings about each name, for as long as a context lives."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._lock = _thread.allocate_lock()  # as above

    def count(self, name: str) -> Say:
        """Count one more pair of endpoints on a name; names beyond the limit share one count."""
        with self._lock:
            if len(self._counts) >= NAMES and name not in self._counts:
                name = ""
            count = self._counts[name] = self._counts.get(name, 0) + 1
        if count <= WARNINGS:
            return Say.ALL
        return Say.NO_MORE if count == WARNINGS + 1 else Say.NOTHING


_GROUP: Final = "ifgen.mismatch"
"""The entry points of what explains a mismatch: `explain(mismatch)`, with a Mismatch as a dictionary."""

_SHOWN: Final = len("RIHS01_") + 16


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


listener: Callable[[Mismatch], None] | None = None
"""Called for each pair of endpoints whose definitions differ, on any thread, with no lock held."""


def report(mismatch: Mismatch, limit: WarningLimit, remarks: Callable[[str], str]) -> str:
    """Pass a mismatch to the listener, and return the text for the log of its node, which may be empty.

    Each transport calls this once a pair. `remarks` are added to the explanation, which they get.
    """
    if listener is not None:
        listener(mismatch)
    match limit.count(mismatch.name):
        case Say.ALL:
            text = explanation(mismatch)
            return text + remarks(text)
        case Say.NO_MORE:
            return f"{mismatch.kind} '{mismatch.name}': more endpoints differ, which is not said any more"
        case _:
            return ""


def explanation(mismatch: Mismatch) -> str:
    """The text of the warning, without a line end: one line, or more if the toolkit is installed.

    It reads files, and takes a part of a second: do not call it in a callback that others wait for. Nothing
    is raised, whatever the definitions are.
    """
    if mismatch.mine.type_hash and mismatch.theirs.type_hash:
        try:
            for found in entry_points(group=_GROUP, name="explain"):
                return str(found.load()(asdict(mismatch)))
        except Exception:  # a broken toolkit must not stop a node
            pass
    return in_one_line(mismatch)


def in_one_line(mismatch: Mismatch) -> str:
    """The same without the toolkit."""
    mine, theirs = mismatch.mine, mismatch.theirs
    if not (mine.type_hash and theirs.type_hash):
        unknown = mine if theirs.type_hash else theirs
        return (
            f"{mismatch.kind} '{mismatch.name}': {unknown.node} ({unknown.role}) does not say which "
            f"definition of {mismatch.type_name} it has, as nodes before ROS 2 Iron. Nobody can tell "
            "whether it is another one"
        )
    return (
        f"{mismatch.kind} '{mismatch.name}': {theirs.node} ({theirs.role}) has another definition of "
        f"{mismatch.type_name} than {mine.node} ({mine.role}): "
        f"{short(theirs.type_hash)}..., not {short(mine.type_hash)}..."
    )


def short(type_hash: str) -> str:
    """As much of a hash as tells it from others."""
    return type_hash[:_SHOWN]


def left_over(rest: int, sender: str, type_name: str) -> str:
    """The report about `rest` bytes that a message of `sender` had too many, without a full stop."""
    number = "1 byte" if rest == 1 else f"{rest} bytes"
    return f"{number} of a message of {sender} were left over after {type_name}. The message was delivered"
