"""Handlers of what processes write while they get ready."""

from __future__ import annotations

from launch.actions import ExecuteLocal
from launch.event_handlers import OnProcessIO
from launch.events.process import ProcessIO
from launch.some_entities_type import SomeEntitiesType

__all__ = ["StdoutReadyListener"]


class StdoutReadyListener(OnProcessIO):
    """Visits actions once, when a process has written a text to stdout."""

    def __init__(self, *, target_action: ExecuteLocal, ready_txt: str, actions: SomeEntitiesType) -> None:
        text = ""
        is_over = False

        def come(event: ProcessIO) -> SomeEntitiesType | None:
            nonlocal text, is_over
            text += event.text.decode(errors="replace")
            if is_over or ready_txt not in text:
                text = text[-len(ready_txt) :]  # it may come in two parts
                return None
            is_over = True
            return actions

        super().__init__(target_action=target_action, on_stdout=come)
