"""Waitables: things of one's own that an executor waits for and executes."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any

from rmw_local.ready import ReadySource

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.typed import Generic, T

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.task import Future


class NumberOfEntities:
    """The number of entities of each kind to wait for."""

    __slots__ = (
        "num_clients",
        "num_events",
        "num_guard_conditions",
        "num_services",
        "num_subscriptions",
        "num_timers",
    )

    def __init__(
        self,
        num_subs: int = 0,
        num_gcs: int = 0,
        num_timers: int = 0,
        num_clients: int = 0,
        num_services: int = 0,
        num_events: int = 0,
    ) -> None:
        self.num_subscriptions = num_subs
        self.num_guard_conditions = num_gcs
        self.num_timers = num_timers
        self.num_clients = num_clients
        self.num_services = num_services
        self.num_events = num_events

    def __add__(self, other: NumberOfEntities) -> NumberOfEntities:
        result = self.__class__()
        for kind in NumberOfEntities.__slots__:
            setattr(result, kind, getattr(self, kind) + getattr(other, kind))
        return result

    def __repr__(self) -> str:
        return (
            f"<{type(self).__name__}({self.num_subscriptions}, {self.num_guard_conditions}, "
            f"{self.num_timers}, {self.num_clients}, {self.num_services}, {self.num_events})>"
        )


class Waitable(Generic[T]):
    """A group of entities that is waited for and executed as one; derive from it."""

    # The sources of rclpy's own waitables, always the same: executors listen to these and need no wait set.
    _fixed_handles: tuple[ReadySource, ...] = ()

    def __init__(self, callback_group: CallbackGroup) -> None:
        self.callback_group = callback_group
        self.callback_group.add_entity(self)
        self._executor_event = False  # a handler exists that has not yet taken its data
        self._futures: list[Future] = []  # their done-callbacks run in the executor

    def __enter__(self) -> None:
        """Keep the entities from being destroyed while they are waited for."""

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        """Allow the entities to be destroyed."""

    def add_future(self, future: Future) -> None:
        """Let the executor call this future's callbacks."""
        self._futures.append(future)

    def remove_future(self, future: Future) -> None:
        """Take back `add_future`."""
        self._futures.remove(future)

    def is_ready(self, wait_set: _rclpy.WaitSet) -> bool:
        """Return whether something of this is ready in the wait set."""
        raise NotImplementedError("Must be implemented by subclass")

    def _find_ready(self) -> bool:
        """Do what `is_ready` does by asking the fixed handles; False if they are destroyed."""
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> Any:
        """Take what is ready, so that it is not ready again at once."""
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: Any) -> None:
        """Work on what `take_data` returned."""
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        """Return how many entities of each kind this adds to a wait set."""
        raise NotImplementedError("Must be implemented by subclass")

    def add_to_wait_set(self, wait_set: _rclpy.WaitSet) -> None:
        """Add the entities to a wait set."""
        raise NotImplementedError("Must be implemented by subclass")
