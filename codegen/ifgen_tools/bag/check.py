"""`ifgen bag check`: whether a bag is whole, can be read, and has the definitions that are installed."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ifgen_tools.bag.reading import reading
from ifgen_tools.bag.saying import show

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Definition

_SHOWN = 20


def check(path: Path, *, as_json: bool, unlimited: bool = False) -> int:
    """Print what is wrong and what differs; the exit code is 1 if something cannot be read."""
    with reading(path, unlimited=unlimited) as bag:
        unreadable, reasons = _unreadable(bag)
        different = {
            definition.type_name: list(islice(_differences(definition), _SHOWN))
            for definition in dict.fromkeys(channel.definition for channel in bag.channels)
        }
        damage = [str(damage) for damage in bag.damage]
    different = {name: lines for name, lines in different.items() if lines}
    if as_json:
        found = {"damage": damage, "unreadable": dict(unreadable), "different": different}
        show(json.dumps(found, indent=2))
    else:
        for topic, count in unreadable.items():
            show(f"{topic}: {count:,} message{'s' * (count != 1)} cannot be read: {reasons[topic]}")
        for name, lines in different.items():
            show(f"{name} is defined otherwise here:")
            show("\n".join(f"  {line}" for line in lines))
        if not (damage or unreadable):
            show(f"{path} is whole: {len(bag):,} messages of {len(bag.topics)} topics")
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
    from ifgen.evolution.edits import Category
    from ifgen.evolution.words import diagnostic

    from ifgen_tools.bag import targets

    new: Any = targets.installed(definition.type_name)
    if new is None or new.type_hash == definition.type_hash:
        return
    old = targets.of_bag(definition)
    if old is None:
        yield f"its hash is {definition.type_hash or 'unknown'}, and {new.type_hash} here"
        return
    for edit in between(old.message, new.message, old.registry, new.registry, with_constants=False):
        said = diagnostic(edit)
        if said is not None and Category.HASH in said.breaks:
            yield said.message
