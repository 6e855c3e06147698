"""The action that starts the tests, and programs that are tests themselves."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from launch.action import Action
from launch.actions import ExecuteProcess
from launch.event_handlers import OnProcessExit
from launch.events import matches_action
from launch.events.process import ProcessExited, ShutdownProcess
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType

__all__ = ["GTest", "PyTest", "ReadyToTest", "Test"]


class ReadyToTest(Action):
    """Says that the processes are ready: the tests begin."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._calls: list[Callable[[], None]] = []

    def add_callback(self, call: Callable[[], None]) -> None:
        """Call a function when it is executed."""
        self._calls.append(call)

    def execute(self, context: LaunchContext) -> None:
        """Start the tests."""
        for call in self._calls:
            call()


class Test(ExecuteProcess):
    """A program that is a test: it is stopped when its time [s] is over."""

    __test__ = False  # for pytest, which would collect a class of this name

    def __init__(self, *, timeout: float | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.timeout = timeout

    def execute(self, context: LaunchContext) -> Any:
        """Start it, and its time."""
        if self.timeout is not None:
            end = ShutdownProcess(process_matcher=matches_action(self))
            timer = context.host.later(self.timeout, lambda: context.host.emit(end), until_shutdown=True)

            def finish(_: ProcessExited, __: LaunchContext) -> None:
                timer.cancel()

            handler = OnProcessExit(target_action=self, on_exit=finish, handle_once=True)
            context.register_event_handler(handler)
        return super().execute(context)


class GTest(Test):
    """A test with GoogleTest."""

    def __init__(self, *, path: SomeSubstitutionsType, timeout: float | None = None, **kwargs: Any) -> None:
        super().__init__(cmd=[path], timeout=timeout, **kwargs)


class PyTest(Test):
    """A file of tests for pytest, in a process of its own."""

    def __init__(self, *, path: SomeSubstitutionsType, timeout: float | None = None, **kwargs: Any) -> None:
        super().__init__(cmd=[sys.executable, "-m", "pytest", path], timeout=timeout, **kwargs)
