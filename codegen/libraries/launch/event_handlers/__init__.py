"""Handlers of the events that launch files answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from launch.action import Action
from launch.event import Event
from launch.event_handler import EventHandler, as_list
from launch.events import ExecutionComplete, IncludeLaunchDescription, Shutdown
from launch.events.process import ProcessExited, ProcessIO, ProcessStarted
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_entities_type import SomeEntitiesType

__all__ = [
    "OnActionEventBase",
    "OnExecutionComplete",
    "OnIncludeLaunchDescription",
    "OnProcessExit",
    "OnProcessIO",
    "OnProcessStart",
    "OnShutdown",
    "event_named",
]

Target: TypeAlias = Action | Callable[[Any], bool] | None
Answer: TypeAlias = SomeEntitiesType | Callable[[Any, LaunchContext], SomeEntitiesType | None]


class OnActionEventBase(EventHandler):
    """Answers events of a kind: of one action, of those that a function accepts, or of all."""

    def __init__(
        self,
        *,
        action_matcher: Target,
        on_event: Answer,
        target_event_cls: type[Event],
        target_action_cls: type[Action] = Action,
        handle_once: bool = False,
    ) -> None:
        if not (
            action_matcher is None
            or callable(action_matcher)
            or isinstance(action_matcher, target_action_cls)
        ):
            raise TypeError(
                f"{type(self).__name__} expects an {target_action_cls.__name__} or a function of one, "
                f"got {action_matcher!r}"
            )

        def matcher(event: Any) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            if action_matcher is None:
                return True
            if isinstance(action_matcher, LaunchDescriptionEntity):
                return getattr(event, "action", None) is action_matcher
            return action_matcher(getattr(event, "action", event))

        self._answer = on_event if callable(on_event) else None
        self.target = action_matcher
        super().__init__(
            matcher=matcher, entities=None if callable(on_event) else on_event, handle_once=handle_once
        )

    def handle(self, event: Event, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return what to visit for an event."""
        entities = super().handle(event, context)
        return entities if self._answer is None else as_list(self._answer(event, context))


class OnProcessStart(OnActionEventBase):
    """Answers the start of processes."""

    def __init__(self, *, target_action: Target = None, on_start: Answer, handle_once: bool = False) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_start,
            target_event_cls=ProcessStarted,
            handle_once=handle_once,
        )


class OnProcessExit(OnActionEventBase):
    """Answers the end of processes."""

    def __init__(self, *, target_action: Target = None, on_exit: Answer, handle_once: bool = False) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_exit,
            target_event_cls=ProcessExited,
            handle_once=handle_once,
        )


class OnExecutionComplete(OnActionEventBase):
    """Answers the end of actions."""

    def __init__(
        self, *, target_action: Target = None, on_completion: Answer, handle_once: bool = False
    ) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=ExecutionComplete,
            handle_once=handle_once,
        )


class OnShutdown(OnActionEventBase):
    """Answers the shutdown of the launch."""

    def __init__(self, *, on_shutdown: Answer, handle_once: bool = False) -> None:
        super().__init__(
            action_matcher=None, on_event=on_shutdown, target_event_cls=Shutdown, handle_once=handle_once
        )


Listener: TypeAlias = Callable[[ProcessIO], SomeEntitiesType | None]


class OnProcessIO(OnActionEventBase):
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
            listener = (on_stdin, on_stdout, on_stderr)[event.fd]
            return None if listener is None else listener(event)

        super().__init__(
            action_matcher=target_action,
            on_event=answer,
            target_event_cls=ProcessIO,
            handle_once=handle_once,
        )


class OnIncludeLaunchDescription(EventHandler):
    """Visits the description of an IncludeLaunchDescription event."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, IncludeLaunchDescription), **kwargs)

    def handle(self, event: Event, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return the description."""
        super().handle(event, context)
        included: Any = event
        return [included.launch_description]


def event_named(name: str) -> Callable[[Event], bool]:
    """Return a matcher of events with a name, such as `launch.events.Shutdown`."""
    return lambda event: event.name == name
