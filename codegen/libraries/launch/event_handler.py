"""Handlers: what to do when events come."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from launch.event import Event
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_entities_type import SomeEntitiesType

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class BaseEventHandler:
    """Handles events that `matcher` accepts, each time or once."""

    def __init__(self, *, matcher: Callable[[Event], bool], handle_once: bool = False) -> None:
        self._matcher = matcher
        self._handle_once = handle_once

    @property
    def entities(self) -> Sequence[LaunchDescriptionEntity]:
        """The entities to visit, as far as they are known."""
        return []

    @property
    def handler_description(self) -> str:
        """Return what it does, for people."""
        return f"<{len(self.entities)} entities>"

    @property
    def matcher_description(self) -> str:
        """Return what it matches, for people."""
        return getattr(self._matcher, "__name__", repr(self._matcher))

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Return what it is, for people, and the entities to visit."""
        matcher, handler = self.matcher_description, self.handler_description
        text = f"{type(self).__name__}(matcher='{matcher}', handler='{handler}')"
        return text, list(self.entities)

    @property
    def handle_once(self) -> bool:
        """Whether it handles one event only."""
        return self._handle_once

    def matches(self, event: Event) -> bool:
        """Return whether this event is for it."""
        return self._matcher(event)

    def handle(self, event: Event, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return what to visit for an event."""
        context.extend_locals({"event": event})
        if self._handle_once:
            context.unregister_event_handler(self)
        return self.entities


class EventHandler(BaseEventHandler):
    """Entities to visit when an event comes that `matcher` accepts, each time or once."""

    def __init__(
        self,
        *,
        matcher: Callable[[Event], bool],
        entities: SomeEntitiesType | None = None,
        handle_once: bool = False,
    ) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self._entities = as_list(entities)

    @property
    def entities(self) -> Sequence[LaunchDescriptionEntity]:
        """The entities to visit."""
        return self._entities


def as_list(entities: SomeEntitiesType | None) -> list[LaunchDescriptionEntity]:
    """Return entities, however they are written, as a list."""
    if entities is None:
        return []
    if isinstance(entities, LaunchDescriptionEntity):
        return [entities]
    if isinstance(entities, Iterable):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        found = list(entities)
        wrong = [entity for entity in found if not isinstance(entity, LaunchDescriptionEntity)]  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        if not wrong:
            return found
        entities = wrong[0]
    raise TypeError(f"expected an action, or a list of actions, got {entities!r}")
