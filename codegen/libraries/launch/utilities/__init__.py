"""Functions about substitutions, entities and classes."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities.signal_management import AsyncSafeSignalManager

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch.some_entities_type import SomeEntitiesType

__all__ = [
    "AsyncSafeSignalManager",
    "create_future",
    "described",
    "ensure_argument_type",
    "is_a",
    "is_a_subclass",
    "isclassinstance",
    "normalize_to_list_of_entities",
    "normalize_to_list_of_substitutions",
    "perform_substitutions",
    "performed",
    "visit_all_entities_and_collect_futures",
]


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return texts and substitutions, however they are written, as a list. Raises TypeError."""
    # It imports this module.
    from launch.substitutions import TextSubstitution

    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, str | Path):
        return [TextSubstitution(text=str(subs))]
    if isinstance(subs, Iterable) and not isinstance(subs, bytes):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        return [one for each in subs for one in normalize_to_list_of_substitutions(each)]
    raise TypeError(f"expected a text, a substitution, or a list of these, got {subs!r}")


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    """Return the texts of substitutions, put together."""
    return "".join(each.perform(context) for each in subs)


def performed(context: LaunchContext, subs: SomeSubstitutionsType) -> str:
    """Return the text of what may be written in several ways."""
    return perform_substitutions(context, normalize_to_list_of_substitutions(subs))


def described(subs: Sequence[Substitution]) -> str:
    """Return how substitutions look to people."""
    return " + ".join(each.describe() for each in subs)


def is_a(obj: object, entity_type: type) -> bool:
    """Whether an object is of a class."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: object, entity_type: type) -> bool:
    """Whether an object is a class that is derived from another one."""
    return isinstance(obj, type) and issubclass(obj, entity_type)


def isclassinstance(obj: object) -> bool:
    """Whether an object is an instance of a class of a program: no class, function, module or plain value."""
    return not isinstance(obj, type) and not callable(obj) and type(obj).__module__ != "builtins"


def ensure_argument_type(
    argument: object, types: type | Iterable[type], argument_name: str, caller: str | None = None
) -> None:
    """Refuse an argument of another class. Raises TypeError, which names it."""
    wanted = (types,) if isinstance(types, type) else tuple(types)
    if not all(isinstance(each, type) for each in wanted):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        raise TypeError(f"expected a class or several, got {types!r}")
    if not isinstance(argument, wanted):
        names = " or ".join(each.__name__ for each in wanted)
        where = "" if caller is None else f"{caller} "
        raise TypeError(f"{where}expected '{argument_name}' to be {names}, got {argument!r}")


def create_future(loop: asyncio.AbstractEventLoop | None) -> asyncio.Future[Any]:
    """Make a future of a loop; None: of the running one."""
    return (asyncio.get_running_loop() if loop is None else loop).create_future()


def normalize_to_list_of_entities(entities: SomeEntitiesType | None) -> list[LaunchDescriptionEntity]:
    """Return entities, however they are written, as a list. Raises TypeError."""
    from launch.event_handler import as_list  # it imports entities, which import this

    return as_list(entities)


def visit_all_entities_and_collect_futures(
    entity: LaunchDescriptionEntity, context: LaunchContext
) -> list[asyncio.Future[Any]]:
    """Visit an entity and all that follows from it; return the futures of those that go on."""
    following = entity.visit(context)
    future = getattr(entity, "get_asyncio_future", lambda: None)()
    futures = [] if future is None else [future]
    for each in following or ():
        futures += visit_all_entities_and_collect_futures(each, context)
    return futures
