"""Definitions side by side: that of a bag, and the one that is installed or that a user names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ifgen.command_kit.tool import ToolError
from ifgen.definition.described.texts import read_sources, read_texts
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.type_description import type_hash
from ifgen.diagnostics import InputError, UsageError
from ifgen.dynamic.texts import sources_in
from ifgen_runtime.bag.definitions import full_text
from ifgen_runtime.bag.topics import Definition
from ifgen_runtime.type_description import sources

from ifgen_tools.types import interface_class

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class Known:
    """A message with all that it needs. `cls` is its class where one is installed."""

    message: Message
    registry: Registry
    cls: type[Any] | None = None

    @property
    def type_hash(self) -> str:
        """The hash of the message."""
        return type_hash(self.message, self.registry)


def of_bag(definition: Definition) -> Known | None:
    """The definition that a bag has; None if it has none that can be understood."""
    if not definition.text:
        return None
    is_idl = definition.encoding == "ros2idl"
    try:
        texts = sources_in(definition.type_name, definition.text, idl=is_idl)
        return _known(*read_texts(definition.type_name, texts))
    except InputError:
        return None


def installed(type_name: str) -> Known | None:
    """The definition that is installed or generated; None if there is none."""
    try:
        cls = interface_class(type_name)
        found = read_sources(type_name, sources(cls))
    except (ToolError, InputError):
        return None
    return None if found is None else _known(*found, cls)


def named(reference: str, type_name: str, paths: Sequence[Path], include: Sequence[Path]) -> Known | None:
    """The definition in a git revision, a folder or a lock file; None if it has none. Raises ToolError."""
    from ifgen.evolution.selection import select  # late: only who names one needs it

    try:
        found = select(f"{reference}:{type_name}", paths, include)
    except UsageError as error:
        if any(d.rule in {"unknown-type", "unknown-package"} for d in error.diagnostics):
            return None
        raise ToolError(error.diagnostics[0].message, help=error.diagnostics[0].help or "") from None
    except InputError as error:
        raise ToolError(f"{reference}: {error}") from None
    interface = found.interfaces.get(type_name)
    return None if interface is None else _known(interface, found.registry)


def definition_of(known: Known) -> Definition:
    """The definition as a bag has it."""
    from ifgen.dynamic.making import make  # late: only what is converted needs it

    text = full_text(make(known.message, known.registry))
    return Definition(known.message.type_name, known.type_hash, "ros2msg", text)


def _known(described: Any, registry: Registry, cls: type[Any] | None = None) -> Known | None:
    return Known(described, registry, cls) if isinstance(described, Message) else None
