"""Wait sets, for waitables and executors that users write; our own executors do not need them."""

from __future__ import annotations

from rmw_local import timing

from .clock import Timer
from .context import Context, GuardCondition
from .handle import Destroyable, RCLError
from .services import Client, Service
from .topics import EventHandle, Subscription

_Entity = Subscription | GuardCondition | Timer | Client | Service | EventHandle


class _Section:
    """The entities of one kind: as many as there is room for, None for those that a wait found not ready."""

    def __init__(self, kind: str, plural: str, size: int) -> None:
        self.kind = kind
        self.plural = plural
        self.size = size
        self.entities: list[_Entity | None] = []

    def add(self, entity: _Entity) -> int:
        if len(self.entities) >= self.size:
            raise RCLError(f"failed to add {self.kind} to wait set: {self.plural} set is full")
        self.entities.append(entity)
        return len(self.entities) - 1

    def is_ready(self, index: int) -> bool:
        if index >= self.size:
            raise IndexError("wait set index too big")
        return index < len(self.entities) and self.entities[index] is not None


class WaitSet(Destroyable):
    """Waits for any of its entities and then holds the ready ones; made with its capacity per kind."""

    def __init__(
        self,
        number_of_subscriptions: int,
        number_of_guard_conditions: int,
        number_of_timers: int,
        number_of_clients: int,
        number_of_services: int,
        number_of_events: int,
        context: Context,
    ) -> None:
        super().__init__()
        if not context.valid:
            raise RCLError("failed to initialize wait set: the given context is not valid")
        self._sections = {
            "subscription": _Section("subscription", "subscriptions", number_of_subscriptions),
            "guard_condition": _Section("guard condition", "guard_conditions", number_of_guard_conditions),
            "timer": _Section("timer", "timers", number_of_timers),
            "client": _Section("client", "clients", number_of_clients),
            "service": _Section("service", "services", number_of_services),
            "event": _Section("event", "events", number_of_events),
        }

    def clear_entities(self) -> None:
        """Forget all entities; the room stays."""
        for section in self._sections.values():
            section.entities.clear()

    def add_subscription(self, subscription: Subscription) -> int:
        """Add a subscription; return its index among the subscriptions."""
        return self._sections["subscription"].add(subscription)

    def add_guard_condition(self, gc: GuardCondition) -> int:
        """Add a guard condition; return its index among the guard conditions."""
        return self._sections["guard_condition"].add(gc)

    def add_timer(self, timer: Timer) -> int:
        """Add a timer; return its index among the timers."""
        return self._sections["timer"].add(timer)

    def add_client(self, client: Client) -> int:
        """Add a client; return its index among the clients."""
        return self._sections["client"].add(client)

    def add_service(self, service: Service) -> int:
        """Add a service; return its index among the services."""
        return self._sections["service"].add(service)

    def add_event(self, event: EventHandle) -> int:
        """Add an event; return its index among the events."""
        return self._sections["event"].add(event)

    def entities(self) -> list[_Entity]:
        """Return everything that was added and that no wait has found not ready."""
        return [each for section in self._sections.values() for each in section.entities if each is not None]

    def is_ready(self, entity_type: str, index: int) -> bool:
        """Whether the last wait found an entity ready."""
        return self._section(entity_type).is_ready(index)

    def get_ready_entities(self, entity_type: str) -> list[int]:
        """Return the pointers of the entities of a kind that the last wait found ready."""
        if entity_type == "event":
            raise RuntimeError("'event' is not a known entity")
        return [each.pointer for each in self._section(entity_type).entities if each is not None]

    def wait(self, timeout: int) -> None:
        """Block until an entity is ready, or for `timeout` ns; negative: without a limit."""
        if not isinstance(timeout, int):
            raise TypeError(f"wait(timeout: int): got {timeout!r}")
        if not any(section.size for section in self._sections.values()):
            raise RCLError("failed to wait on wait set: wait set is empty")
        entities = [
            each for section in self._sections.values() for each in section.entities if each is not None
        ]
        _block_until_any(entities, None if timeout < 0 else timing.monotonic_ns() + timeout)
        for section in self._sections.values():
            section.entities = [_if_ready(entity) for entity in section.entities]

    def _section(self, entity_type: str) -> _Section:
        section = self._sections.get(entity_type)
        if section is None:
            raise RuntimeError(f"'{entity_type}' is not a known entity")
        return section


def _if_ready(entity: _Entity | None) -> _Entity | None:
    """Return the entity if it is ready; seeing a guard condition's flag clears it."""
    if isinstance(entity, GuardCondition):
        return entity if entity.take() else None
    return entity if entity is not None and entity.is_ready() else None


def _block_until_any(sources: list[_Entity], until: int | None) -> None:
    waker = timing.make_waker()
    for source in sources:
        source.add_listener(waker.wake)
    try:
        while not any(source.is_ready() for source in sources):
            alarm = _earliest(sources, until)
            if not timing.wait(waker, alarm) and alarm == until:
                return
    finally:
        for source in sources:
            source.remove_listener(waker.wake)


def _earliest(sources: list[_Entity], until: int | None) -> int | None:
    moments = [at for source in sources if (at := source.wake_at()) is not None]
    return min([*moments, until] if until is not None else moments, default=None)
