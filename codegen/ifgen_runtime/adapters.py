"""Functions that convert messages between two versions of a type. `ifgen adapt` writes them for users.

A module of adapters registers them when it is imported. Subscriptions, services and readers of recorded data
look them up by the hash of the other version.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True, slots=True)
class Adapter:
    """The two versions of a message, and how to get from one to the other.

    `old` is the class of the other version, with its `__type_hash__`; `new` the one that the program uses.
    `downgrade` is None if nobody wrote it: then nothing can be sent to the other version.
    """

    old: type[Any]
    new: type[Any]
    upgrade: Callable[[Any], Any]
    downgrade: Callable[[Any], Any] | None = None


_ADAPTERS: dict[tuple[str, type[Any]], Adapter] = {}


def register(adapter: Adapter) -> None:
    """Use an adapter from now on, instead of an earlier one for the same two versions."""
    _ADAPTERS[adapter.old.__type_hash__, adapter.new] = adapter


def adapter_for(type_hash: str, cls: type[Any]) -> Adapter | None:
    """The adapter from the version with this hash to a class; None if none is registered.

    For messages, and for the requests and responses of services.
    """
    return _ADAPTERS.get((type_hash, cls))
