"""Handlers of the events that launch files answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from launch.action import Action
from launch.event import Event
from launch.event_handler import EventHandler, as_list
from launch.events import ExecutionComplete, Shutdown
from launch.events.process import ProcessExited, ProcessIO, ProcessStarted
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_entities_type import SomeEntitiesType

__all__ = ["OnExecutionComplete", "OnProcessExit", "OnProcessIO", "OnProcessStart", "OnShutdown"]

Target: TypeAlias = Action | Callable[[Any], bool] | None
Answer: TypeAlias = SomeEntitiesType | Callable[[Any, LaunchContext], SomeEntitiesType | None]


class _Answering(EventHandler):
    """Answers events of a kind, of one action, of those that a function accepts, or of all."""

    def __init__(
        self, kind: type[Event], target: Target, answer: Answer, *, handle_once: bool = False
    ) -> None:
        def matcher(event: Any) -> bool:
            if not isinstance(event, kind):
                return False
            if target is None:
                return True
            if isinstance(target, LaunchDescriptionEntity):
                return getattr(event, "action", None) is target
            return target(getattr(event, "action", event))

        self._answer = answer if callable(answer) else None
        self.target = target
        super().__init__(
            matcher=matcher, entities=None if callable(answer) else answer, handle_once=handle_once
        )

    def handle(self, event: Event, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return what to visit for an event."""
        entities = super().handle(event, context)
        return entities if self._answer is None else as_list(self._answer(event, context))


class OnProcessStart(_Answering):
    """Answers the start of processes."""

    def __init__(self, *, target_action: Target = None, on_start: Answer, handle_once: bool = False) -> None:
        super().__init__(ProcessStarted, target_action, on_start, handle_once=handle_once)


class OnProcessExit(_Answering):
    """Answers the end of processes."""

    def __init__(self, *, target_action: Target = None, on_exit: Answer, handle_once: bool = False) -> None:
        super().__init__(ProcessExited, target_action, on_exit, handle_once=handle_once)


class OnExecutionComplete(_Answering):
    """Answers the end of actions."""

    def __init__(
        self, *, target_action: Target = None, on_completion: Answer, handle_once: bool = False
    ) -> None:
        super().__init__(ExecutionComplete, target_action, on_completion, handle_once=handle_once)


class OnShutdown(_Answering):
    """Answers the shutdown of the launch."""

    def __init__(self, *, on_shutdown: Answer, handle_once: bool = False) -> None:
        super().__init__(Shutdown, None, on_shutdown, handle_once=handle_once)


Listener: TypeAlias = Callable[[ProcessIO], SomeEntitiesType | None]


class OnProcessIO(_Answering):
    """Answers what processes write."""

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_stdin: Listener | None = None,
        on_stdout: Listener | None = None,
        on_stderr: Listener | None = None,
        handle_once: bool = False,
    ) -> None:
        def answer(event: ProcessIO, context: LaunchContext) -> SomeEntitiesType | None:
            listener = on_stdout if event.from_stdout else on_stderr
            return None if listener is None else listener(event)

        super().__init__(ProcessIO, target_action, answer, handle_once=handle_once)
