"""Events, handlers, timers and messages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from launch.action import Action
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.event import Event
from launch.event_handler import EventHandler, as_list
from launch.events import Shutdown as ShutdownEvent
from launch.events import TimerEvent
from launch.launch_context import LaunchContext, Timer
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.logging import get_logger
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Event, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        if not isinstance(event, Event):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
            raise RuntimeError(f"EmitEvent expects an event, got {event!r}")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Emit it."""
        context.emit_event_sync(self.event)


class Shutdown(EmitEvent):
    """Ends the launch, and all its processes."""

    def __init__(
        self,
        *,
        reason: SomeSubstitutionsType = "reason not given",
        condition: Condition | None = None,
    ) -> None:
        super().__init__(event=ShutdownEvent(), condition=condition)
        self.reason = normalize_to_list_of_substitutions(reason)

    def execute(self, context: LaunchContext) -> None:
        """Emit the event, once."""
        if not context.is_shutdown:
            context.emit_event_sync(ShutdownEvent(reason=perform_substitutions(context, self.reason)))


class RegisterEventHandler(Action):
    """Registers a handler."""

    def __init__(self, event_handler: EventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def describe_conditional_sub_entities(self) -> Sequence[tuple[str, Sequence[LaunchDescriptionEntity]]]:
        """Return the handler's entities."""
        return [(type(self.event_handler).__name__, self.event_handler.entities)]

    def execute(self, context: LaunchContext) -> None:
        """Register it."""
        context.register_event_handler(self.event_handler)


class UnregisterEventHandler(Action):
    """Removes a handler."""

    def __init__(self, event_handler: EventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Remove it. Raises ValueError if it is not registered."""
        context.unregister_event_handler(self.event_handler)


class TimerAction(Action):
    """Actions that are done after a time [s]."""

    def __init__(
        self,
        *,
        period: float | SomeSubstitutionsType,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | SomeSubstitutionsType = True,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.period = normalize_to_list_of_substitutions(
            str(period) if isinstance(period, int | float) else period
        )
        self.actions: list[LaunchDescriptionEntity] = as_list(actions)
        self.cancel_on_shutdown = (
            str(cancel_on_shutdown) if isinstance(cancel_on_shutdown, bool) else cancel_on_shutdown
        )
        self._timer: Timer | None = None

    def describe_conditional_sub_entities(self) -> Sequence[tuple[str, Sequence[LaunchDescriptionEntity]]]:
        """Return its actions."""
        return [("after its time", self.actions)]

    def ends_later(self) -> bool:
        """Return True: it goes on until its time has come."""
        return True

    def cancel(self) -> None:
        """Do not do its actions, unless they are done already."""
        if self._timer is not None:
            self._timer.cancel()

    def execute(self, context: LaunchContext) -> None:
        """Start the time. Raises RuntimeError if its period is no number."""
        text = perform_substitutions(context, self.period)
        try:
            seconds = float(text)
        except ValueError:
            raise RuntimeError(f"the period of a timer must be a number of seconds, got '{text}'") from None
        until_shutdown = evaluate_condition_expression(context, self.cancel_on_shutdown)

        def come() -> None:
            context.host.handle(TimerEvent(timer_action=self))
            context.host.visit(self.actions)
            context.host.completed(self)

        self._timer = self.start(context, max(seconds, 0.0), come, until_shutdown=until_shutdown)

    def start(
        self, context: LaunchContext, seconds: float, call: Callable[[], None], *, until_shutdown: bool
    ) -> Timer:
        """Start to wait, by the clock of the machine."""
        return context.host.later(seconds, call, until_shutdown=until_shutdown)


class LogInfo(Action):
    """Prints a message."""

    def __init__(self, *, msg: SomeSubstitutionsType, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.msg = normalize_to_list_of_substitutions(msg)

    def execute(self, context: LaunchContext) -> None:
        """Print it."""
        get_logger("launch.user").info("%s", perform_substitutions(context, self.msg))
