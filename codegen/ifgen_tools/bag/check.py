"""`ifgen bag check`, and the definitions of a bag beside those that are installed, or that a user names."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen.definition.described.texts import read_sources, read_texts
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.type_description import type_hash
from ifgen.diagnostics import InputError, UsageError
from ifgen.dynamic.texts import sources_in
from ifgen_runtime.bag.definitions import full_text
from ifgen_runtime.bag.topics import Definition
from ifgen_runtime.type_description import sources

from ifgen_tools.bag.files import reading, show
from ifgen_tools.types import interface_class

if TYPE_CHECKING:
    from pathlib import Path

    from ifgen_runtime.bag import Bag

    from ifgen_tools.bag.options import CheckOptions

_SHOWN: Final = 20


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


def definition_in_bag(definition: Definition) -> Known | None:
    """The definition that a bag has; None if it has none that can be understood."""
    if not definition.text:
        return None
    is_idl = definition.encoding == "ros2idl"
    try:
        texts = sources_in(definition.type_name, definition.text, idl=is_idl)
        return _known(*read_texts(definition.type_name, texts))
    except InputError:
        return None


def installed_definition(type_name: str) -> Known | None:
    """The definition that is installed or generated; None if there is none."""
    try:
        cls = interface_class(type_name)
        described = read_sources(type_name, sources(cls))
    except (ToolError, InputError):
        return None
    return None if described is None else _known(*described, cls)


def named_definition(
    reference: str, type_name: str, paths: Sequence[Path], include: Sequence[Path]
) -> Known | None:
    """The definition in a git revision, a folder or a lock file; None if it has none. Raises ToolError."""
    from ifgen.evolution.selection import select  # late: only whoever names one needs it

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


def bag_definition(known: Known) -> Definition:
    """The definition as a bag has it."""
    from ifgen.dynamic.making import make  # late: only what is converted needs it

    text = full_text(make(known.message, known.registry))
    return Definition(known.message.type_name, known.type_hash, "ros2msg", text)


def _known(described: Any, registry: Registry, cls: type[Any] | None = None) -> Known | None:
    return Known(described, registry, cls) if isinstance(described, Message) else None


def check(options: CheckOptions) -> int:
    """Print what is wrong and what differs; the exit code is 1 if something cannot be read."""
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        unreadable, reasons = _unreadable(bag)
        different = {
            definition.type_name: list(islice(_differences(definition), _SHOWN))
            for definition in dict.fromkeys(channel.definition for channel in bag.channels)
        }
        damage = [str(damage) for damage in bag.damage]
    different = {name: lines for name, lines in different.items() if lines}
    if options.as_json:
        found = {"damage": damage, "unreadable": dict(unreadable), "different": different}
        show(json.dumps(found, indent=2))
    else:
        for topic, count in unreadable.items():
            show(f"{topic}: {count:,} message{'s' * (count != 1)} cannot be read: {reasons[topic]}")
        for name, lines in different.items():
            show(f"{name} is defined otherwise here:")
            show("\n".join(f"  {line}" for line in lines))
        if not (damage or unreadable):
            show(f"{options.bag_path} is whole: {len(bag):,} messages of {len(bag.topics)} topics")
    return 1 if damage or unreadable else 0


def _unreadable(bag: Bag) -> tuple[Counter[str], dict[str, str]]:
    """How many messages of which topic cannot be read, and why the first of each cannot."""
    from ifgen_runtime.bag import BagError  # late, as Bag

    count: Counter[str] = Counter()
    reasons: dict[str, str] = {}
    for recorded in bag:
        try:
            _ = recorded.message
        except BagError as error:
            count[recorded.topic] += 1
            reasons.setdefault(recorded.topic, str(error))
    return count, reasons


def _differences(definition: Definition) -> Iterator[str]:
    """The differences between the definition in a bag and the one that is installed, if there is one."""
    # Late: a bag whose definitions are those that are installed needs no toolkit.
    from ifgen.evolution.compare import between
    from ifgen.evolution.edit_diagnostics import diagnostic
    from ifgen.evolution.edits import Category

    new = installed_definition(definition.type_name)
    if new is None or new.type_hash == definition.type_hash:
        return
    old = definition_in_bag(definition)
    if old is None:
        yield f"its hash is {definition.type_hash or 'unknown'}, and {new.type_hash} here"
        return
    for edit in between(old.message, new.message, old.registry, new.registry, with_constants=False):
        said = diagnostic(edit)
        if said is not None and Category.HASH in said.breaks:
            yield said.message
