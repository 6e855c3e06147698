"""Functions that convert messages between two versions of a type. `ifgen adapt` writes them for users.

A module of adapters registers them when it is imported. Subscriptions, services and readers of recorded data
look them up by the hash of the other version.
"""

from __future__ import annotations

import copyreg
import sys
from collections import deque
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, Never, TypeVar

from ifgen_runtime.codec import deserialize, serialize

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ifgen_runtime.codec import Buffer

__all__ = [
    "Adapter",
    "AdapterError",
    "Undecided",
    "UndecidedError",
    "adapter_for",
    "decode",
    "import_all",
    "lost",
    "pickled_from",
    "register",
    "short",
    "unchanged",
    "undecided",
]

MessageT = TypeVar("MessageT")


class AdapterError(LookupError):
    """There is no adapter, or one was written for another version than the program has."""


@dataclass(frozen=True, slots=True)
class Adapter:
    """The two versions of a message, and how to get from one to the other.

    `old` is the class of the other version, with its `__type_hash__`; `new` the one that the program uses.
    `downgrade` is None if nobody wrote it: then nothing can be sent to the other version.

    `new_hash` is the hash of the version that `upgrade` was written for. `within` is the hash of the other
    version of the service or the action, for a part of one: peers are known by that.
    """

    old: type[Any]
    new: type[Any]
    upgrade: Callable[[Any], Any]
    downgrade: Callable[[Any], Any] | None = None
    new_hash: str = ""
    within: str = ""

    def __post_init__(self) -> None:
        """Compare the version that this was written for with the one that is there."""
        found = _hash_of(self.new)
        if self.new_hash and found and found != self.new_hash:
            raise AdapterError(_outdated(self, found))


def _outdated(adapter: Adapter, found: str) -> str:
    package, folder, module = adapter.old.__module__.partition("@")[0].split(".")[:3]
    name, written_for = adapter.old.__name__.partition("_")[0], short(adapter.new_hash)
    import_ = f", and `from .{module}_{written_for} import {name}` imports it into this module"
    return (
        f"the adapter from {name} {short(_hash_of(adapter.old))} was written for {name} {written_for}, and "
        f"{name} is {short(found)} now: `ifgen adapt {package}/{folder}/{name} --from {written_for}` freezes "
        f"that version{', and says how to import it here' if adapter.within else import_}. If the class is "
        "not that of your interfaces, run `ifgen generate`"
    )


_registered: dict[tuple[str, type[Any]], Adapter] = {}
_found: dict[tuple[str, type[Any]], Adapter] = {}
"""The results of `adapter_for` since an adapter was registered, chains included."""

_compiled: dict[type[Any], str] = {}
"""The type hashes of classes that do not know them."""


def register(adapter: Adapter) -> None:
    """Use an adapter from now on, instead of an earlier one for the same two versions."""
    for type_hash in {_hash_of(adapter.old), adapter.within} - {""}:
        _registered[type_hash, adapter.new] = adapter
    _found.clear()


def adapter_for(type_hash: str, cls: type[Any]) -> Adapter | None:
    """The adapter from the version with this hash to a class; None if none is registered.

    For messages, and for the parts of services and actions, by the hash of the other part or of the service
    or action that it belongs to. Where no adapter does it in one step, it is the shortest chain: from A to B,
    and from B to `cls`.
    """
    key = type_hash, cls
    found = _found.get(key)
    if found is None and (found := _registered.get(key) or _chain(type_hash, cls)) is not None:
        _found[key] = found
    return found


def decode(data: Buffer, type_hash: str, cls: type[MessageT]) -> MessageT:
    """The message of class `cls` in the bytes of a message of the version with this hash.

    Raises AdapterError if there is no adapter, and DeserializationError if the bytes hold no such message.
    """
    if type_hash == _hash_of(cls):
        return deserialize(data, cls)
    adapter = adapter_for(type_hash, cls)
    if adapter is None:
        raise AdapterError(
            f"no adapter from {short(type_hash)} to {cls.__name__} {short(_hash_of(cls))} is registered: "
            f"`ifgen adapt TYPE --from {short(type_hash)}` writes one, and importing it registers it"
        )
    upgraded: MessageT = adapter.upgrade(deserialize(data, adapter.old))
    return upgraded


def import_all(package: str) -> None:
    """Import the modules of adapters in a package, which registers them."""
    for module in iter_modules(sys.modules[package].__path__):
        if not module.name.startswith(("_", "test_", "conftest")):
            import_module(f"{package}.{module.name}")


def pickled_from(module: str, *classes: type[Any]) -> None:
    """Let pickle find frozen classes in the module that has them: their names say that they are elsewhere."""
    for cls in classes:
        copyreg.pickle(type(cls), lambda cls: (_class_in, (module, cls.__name__)))


def _class_in(module: str, name: str) -> type[Any]:
    found: type[Any] = getattr(import_module(module), name)
    return found


def short(type_hash: str) -> str:
    """The first digits of a hash, which tell versions of a type apart."""
    return type_hash.removeprefix("RIHS01_")[:8]


def unchanged(message: MessageT) -> MessageT:
    """Convert a part of a service or an action that is the same in both versions."""
    return message


def in_class(cls: type[MessageT], message: Any) -> MessageT:
    """A message of another class of the same version as one of `cls`, by way of its bytes."""
    return message if isinstance(message, cls) else deserialize(serialize(message), cls)


def _hash_of(cls: type[Any]) -> str:
    found: str | None = getattr(cls, "__type_hash__", None)
    return _hash_of_compiled(cls) if found is None else found


def _hash_of_compiled(cls: type[Any]) -> str:
    """The type hash of a class of rosidl's, which does not know it."""
    if cls not in _compiled:
        from ifgen_runtime.type_description import type_hash  # most programs have no such class here

        _compiled[cls] = type_hash(cls)
    return _compiled[cls]


def _chain(type_hash: str, cls: type[Any]) -> Adapter | None:
    """Adapters one after the other; each version is visited once, so no circle can hold this up."""
    visited = {_hash_of(cls)}
    if type_hash in visited:
        return None
    pending: deque[tuple[Adapter, ...]] = deque((step,) for step in _steps_to(_hash_of(cls), cls))
    while pending:
        steps = pending.popleft()
        first = steps[0]
        if type_hash in {_hash_of(first.old), first.within}:
            return _joined(steps, cls)
        if _hash_of(first.old) not in visited:
            visited.add(_hash_of(first.old))
            pending.extend((before, *steps) for before in _steps_to(_hash_of(first.old), first.old))
    return None


def _steps_to(type_hash: str, cls: type[Any]) -> Iterator[Adapter]:
    """The adapters to a class, then those to other classes of the same version."""
    others: list[Adapter] = []
    for adapter in dict.fromkeys(_registered.values()):
        if adapter.new is cls:
            yield adapter
        elif type_hash and type_hash in {adapter.new_hash, _hash_of(adapter.new)}:
            others.append(adapter)
    yield from others


def _joined(steps: tuple[Adapter, ...], cls: type[Any]) -> Adapter:
    old, last = steps[0].old, steps[-1]

    def upgrade(message: Any) -> Any:
        for step in steps:
            message = step.upgrade(in_class(step.old, message))
        return in_class(cls, message)

    def downgrade(message: Any) -> Any:
        for step in reversed(steps):
            assert step.downgrade is not None
            message = step.downgrade(in_class(step.new, message))
        return in_class(old, message)

    is_complete = all(step.downgrade is not None for step in steps)
    return Adapter(old, cls, upgrade, downgrade if is_complete else None, last.new_hash, steps[0].within)


class UndecidedError(NotImplementedError):
    """A message cannot be converted before a person has decided how: the file, the line and the field."""


class Undecided:
    """The type of what is left to decide. No field takes it, so type checkers report each place."""


def undecided(question: str) -> Undecided:
    """Stand for a value that a person has to decide on; the question names the field."""
    raise _left_open(question)


def lost(value: Never, question: str) -> None:
    """Stand for the decision what becomes of a value that the other version has no field for."""
    raise _left_open(question)


def _left_open(question: str) -> UndecidedError:
    import inspect  # takes longer to import than all adapters

    frame = inspect.stack(0)[2]
    return UndecidedError(f"{frame.filename}:{frame.lineno}: {question}")
