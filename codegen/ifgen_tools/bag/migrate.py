"""`ifgen bag migrate`: messages of earlier definitions become messages of today's, in another bag.

Where no adapter of the user converts them, each field gets its value as `ifgen adapt` would write it. Here
the expressions run, instead of being written into a module.
"""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen.config.settings import settle
from ifgen.dynamic.making import make
from ifgen.evolution.adapting.steps import PARAMETERS, Function, Functions, TwoVersions
from ifgen_runtime.adapters import adapter_for
from ifgen_runtime.bag.topics import Channel
from ifgen_runtime.codec import deserialize, serialize

from ifgen_tools.bag.check import (
    Known,
    bag_definition,
    definition_in_bag,
    installed_definition,
    named_definition,
)
from ifgen_tools.bag.files import EVERYTHING, Part, Passage, reading, show, write_part

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Definition

    from ifgen_tools.bag.options import MigrateOptions

_BUILTINS: Final = {name: getattr(builtins, name) for name in ("bytes", "float")}
"""The functions that the expressions of conversions call."""


@dataclass(frozen=True, slots=True)
class Loss:
    """The losses of a conversion, and what it leaves open. `place` is `pkg/msg/Name.field`."""

    place: str
    reason: str
    is_lost: bool


@dataclass(frozen=True, slots=True)
class Plan:
    """The way in which messages of a definition are converted, and what is lost."""

    how: str
    target: Definition | None = None
    convert: Callable[[bytes], bytes] | None = None
    losses: tuple[Loss, ...] = ()


def migrate(options: MigrateOptions) -> int:
    """Write a bag with today's definitions, or say with `check` what that would do."""
    format = options.file_format()
    _import_adapters(options.adapters)
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        plans = _plans(bag, options.reference)
        losses = {definition.type_name: plan.losses for definition, plan in plans.items() if plan.losses}
        if options.check or (losses and not options.lossy):
            _report(plans)
        if options.check:
            return 1 if losses else 0
        if losses and not options.lossy:
            raise ToolError(
                f"{sum(map(len, losses.values()))} fields would be lost or left at their defaults",
                help=f"write an adapter with `ifgen adapt {next(iter(losses))}`, or accept it with --lossy",
            )
        output = options.output
        if output is None:
            raise ToolError("there is no place to write to", help="name one with -o, or use --check")

        def passage(channel: Channel) -> Passage:
            plan = plans[channel.definition]
            if plan.target is None:
                return Passage(channel)
            return Passage(Channel(channel.topic, plan.target, channel.qos, channel.encoding), plan.convert)

        count = write_part(bag, output, format, Part(EVERYTHING), passage)
    changed = sum(plan.convert is not None for plan in plans.values())
    show(f"wrote {output}: {count:,} message{'s' * (count != 1)}, {changed} of {len(plans)} types converted")
    return 0


def _import_adapters(module: str) -> None:
    """Register the user's adapters: those of a module, or those in the folder of the configuration."""
    folder = settle().config.adapters
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
        named_definition(reference, name, settings.paths, settings.include)
        if reference
        else installed_definition(name)
    )
    if new is None:
        return Plan(f"stays: {reference or 'nothing that is installed'} has no such type")
    old = definition_in_bag(definition)
    old_hash = definition.type_hash or (old.type_hash if old else "")
    if old_hash == new.type_hash:
        return Plan("stays: it is the same")
    adapter = adapter_for(old_hash, new.cls) if new.cls is not None and old_hash else None
    if adapter is not None:
        before, upgrade = adapter.old, adapter.upgrade
        return Plan(
            "by an adapter",
            bag_definition(new),
            lambda data: bytes(serialize(upgrade(deserialize(data, before)))),
        )
    if old is None:
        raise ToolError(
            f"the bag has no definition of {name} that can be understood",
            help=f"name adapters that have {definition.type_hash or 'it'} with --adapters",
        )
    convert, losses = _conversion(old, new)
    return Plan("field by field", bag_definition(new), convert, losses)


def _report(plans: dict[Definition, Plan]) -> None:
    for definition, plan in plans.items():
        show(f"{definition.type_name}: {plan.how}")
        for loss in plan.losses:
            show(f"  {loss.place}: {'lost' if loss.is_lost else 'left at its default'}: {loss.reason}")


def _conversion(old: Known, new: Known) -> tuple[Callable[[bytes], bytes], tuple[Loss, ...]]:
    """The conversion of bytes from an old to a new definition of a message, and what it loses.

    Fields that nobody decided on get their default values. Their names are in the losses, with those that
    the new definition has no field for.
    """

    def today(name: str) -> Any:
        interface = new.registry.get(name)
        return None if interface is None else (interface, new.registry)

    functions = Functions(TwoVersions(old.message, new.message, old.registry, new.registry, today, ""))
    functions.add("upgrade", "upgrade", old.message, new.message)
    compiled: dict[str, Any] = {}
    for function in functions:
        compiled[function.name] = _compiled(function, make(function.target, new.registry), compiled)
    old_class, upgrade = make(old.message, old.registry), compiled["upgrade"]

    def convert(data: bytes) -> bytes:
        return bytes(serialize(upgrade(deserialize(data, old_class))))

    return convert, tuple(loss for function in functions for loss in _losses(function))


def _compiled(function: Function, target: type[Any], others: dict[str, Any]) -> Callable[[Any], Any]:
    """The function as Python runs it. Names are safe, because whoever read the definitions checked them."""
    values = ", ".join(f"{name}={value}" for name, value in function.converted())
    source = f"lambda {PARAMETERS[function.direction]}: _target_({values})"
    names = {"__builtins__": _BUILTINS, "_target_": target, **others}
    compiled: Callable[[Any], Any] = eval(source, names)
    return compiled


def _losses(function: Function) -> Iterator[Loss]:
    for field in function.lost:
        place = f"{function.source.type_name}.{field.name}"
        yield Loss(place, "the new definition has no such field", is_lost=True)
    for step in function.steps:
        if step.question:
            place = f"{function.target.type_name}.{step.target.name}"
            yield Loss(place, step.question, is_lost=step.source is not None)
