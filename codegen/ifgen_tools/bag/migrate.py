"""`ifgen bag migrate`: messages of earlier definitions become messages of today's, in another bag."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.settings import settle
from ifgen_runtime.adapters import adapter_for
from ifgen_runtime.bag.topics import Channel
from ifgen_runtime.bag.writer import Format
from ifgen_runtime.codec import deserialize, serialize

from ifgen_tools.bag import targets
from ifgen_tools.bag.conversions import Loss, conversion
from ifgen_tools.bag.copying import Part, Passage, everything, written
from ifgen_tools.bag.reading import reading
from ifgen_tools.bag.saying import show
from ifgen_tools.errors import ToolError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Definition

    from ifgen_tools.bag.targets import Known


@dataclass(frozen=True, slots=True)
class Plan:
    """The way in which messages of a definition are converted, and what is lost."""

    how: str
    target: Definition | None = None
    convert: Callable[[bytes], bytes] | None = None
    losses: tuple[Loss, ...] = ()


def migrate(
    path: Path,
    output: Path | None,
    format: Format,
    reference: str,
    adapters: str,
    *,
    check: bool,
    lossy: bool,
    unlimited: bool = False,
) -> int:
    """Write a bag with today's definitions, or say with `check` what that would do."""
    _import_adapters(adapters)
    with reading(path, unlimited=unlimited) as bag:
        plans = _plans(bag, reference)
        losses = {definition.type_name: plan.losses for definition, plan in plans.items() if plan.losses}
        if check or (losses and not lossy):
            _report(plans)
        if check:
            return 1 if losses else 0
        if losses and not lossy:
            raise ToolError(
                f"{sum(map(len, losses.values()))} fields would be lost or left at their defaults",
                help=f"write an adapter with `ifgen adapt {next(iter(losses))}`, or accept it with --lossy",
            )
        if output is None:
            raise ToolError("there is no place to write to", help="name one with -o, or use --check")

        def passage(channel: Channel) -> Passage:
            plan = plans[channel.definition]
            if plan.target is None:
                return Passage(channel)
            return Passage(Channel(channel.topic, plan.target, channel.qos, channel.encoding), plan.convert)

        count = written(bag, output, format, Part(everything()), passage)
    changed = sum(plan.convert is not None for plan in plans.values())
    show(f"wrote {output}: {count:,} message{'s' * (count != 1)}, {changed} of {len(plans)} types converted")
    return 0


def _import_adapters(module: str) -> None:
    """Register the user's adapters: those of a module, or those in the folder of the configuration."""
    folder = settle().adapters
    if not module and not (folder / "__init__.py").is_file():
        return
    sys.path.insert(0, str(Path.cwd() if module else folder.parent))
    try:
        import_module(module or folder.name)
    except Exception as error:
        name = module or folder.name
        raise ToolError(f"the adapters {name} cannot be imported: {error}", help="see --adapters") from None


def _plans(bag: Bag, reference: str) -> dict[Definition, Plan]:
    definitions = dict.fromkeys(channel.definition for channel in bag.channels)
    return {definition: _plan(definition, reference) for definition in definitions}


def _plan(definition: Definition, reference: str) -> Plan:
    settings = settle()
    name = definition.type_name
    new = (
        targets.named(reference, name, settings.paths, settings.include)
        if reference
        else targets.installed(name)
    )
    if new is None:
        return Plan(f"stays: {reference or 'nothing that is installed'} has no such type")
    old = targets.of_bag(definition)
    old_hash = definition.type_hash or (old.type_hash if old else "")
    if old_hash == new.type_hash:
        return Plan("stays: it is the same")
    adapter = adapter_for(old_hash, new.cls) if new.cls is not None and old_hash else None
    if adapter is not None:
        before, upgrade = adapter.old, adapter.upgrade
        return Plan(
            "by an adapter",
            targets.definition_of(new),
            lambda data: bytes(serialize(upgrade(deserialize(data, before)))),
        )
    if old is None:
        raise ToolError(
            f"the bag has no definition of {name} that can be understood",
            help=f"name adapters that have {definition.type_hash or 'it'} with --adapters",
        )
    return _by_fields(old, new)


def _by_fields(old: Known, new: Known) -> Plan:
    found = conversion(old.message, old.registry, new.message, new.registry)
    return Plan("field by field", targets.definition_of(new), found.convert, found.losses)


def _report(plans: dict[Definition, Plan]) -> None:
    for definition, plan in plans.items():
        show(f"{definition.type_name}: {plan.how}")
        for loss in plan.losses:
            show(f"  {loss.place}: {'lost' if loss.is_lost else 'left at its default'}: {loss.reason}")
