# Tests are the users', of any type.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Runs launch tests: the launch in this thread, the tests beside it in another one, then those after it."""

from __future__ import annotations

import threading
import unittest
from collections.abc import Iterable, Sequence
from typing import Any

from launch import LaunchDescription, LaunchDescriptionEntity, LaunchDescriptionSource, LaunchService
from launch.actions import IncludeLaunchDescription, RegisterEventHandler
from launch.event_handlers import OnProcessExit, OnProcessIO, OnProcessStart

from launch_testing.io_handler import ActiveIoHandler
from launch_testing.loader import TestRun
from launch_testing.proc_info_handler import ActiveProcInfoHandler
from launch_testing.util import KeepAliveProc

__all__ = ["LaunchTestRunner", "TestResult", "parse_launch_arguments"]


class TestResult(unittest.TextTestResult):
    """The result of the tests of one run."""

    __test__ = False  # pytest takes it for a class of tests otherwise

    def append(self, other: unittest.TestResult) -> None:
        """Add another result."""
        self.failures += other.failures
        self.errors += other.errors
        self.skipped += other.skipped
        self.unexpectedSuccesses += other.unexpectedSuccesses
        self.testsRun += other.testsRun


def parse_launch_arguments(launch_arguments: Iterable[str]) -> list[tuple[str, str]]:
    """Return the names and values of `name:=value`. Raises ValueError."""
    found: dict[str, str] = {}
    for each in launch_arguments:
        name, separator, value = each.partition(":=")
        if not separator or not name:
            raise ValueError(f"malformed launch argument '{each}', expected format '<name>:=<value>'")
        found[name] = value
    return list(found.items())


class LaunchTestRunner:
    """Runs each run of a module."""

    def __init__(
        self, test_runs: Sequence[TestRun], launch_file_arguments: Iterable[str] = (), debug: bool = False
    ) -> None:
        self._runs = list(test_runs)
        self._arguments = parse_launch_arguments(launch_file_arguments)
        self._debug = debug

    def validate(self) -> None:
        """Raise TypeError for a function that wants arguments which nobody gives."""
        for run in self._runs:
            run.describe(lambda: None)

    def run(self) -> dict[TestRun, TestResult]:
        """Return the results of all runs."""
        return {run: self._result(run) for run in self._runs}

    def _result(self, run: TestRun) -> TestResult:
        try:
            return _Launch(run, self._arguments, debug=self._debug).result()
        except unittest.SkipTest as skip:
            result = _result_of(unittest.TestSuite())
            result.skipped.append((unittest.FunctionTestCase(lambda: None, description=str(run)), str(skip)))
            return result


class _Launch:
    def __init__(self, run: TestRun, arguments: list[tuple[str, str]], *, debug: bool) -> None:
        self._run = run
        self._arguments = arguments
        self._service = LaunchService(debug=debug)
        self._info = ActiveProcInfoHandler()
        self._output = ActiveIoHandler()
        self._is_ready = threading.Event()
        self._active: TestResult | None = None
        self._problem = ""

    def result(self) -> TestResult:
        run = self._run
        description, context = run.describe(self._is_ready.set)
        given: dict[str, Any] = {
            **context,
            **run.param_args,
            "proc_info": self._info,
            "proc_output": self._output,
            "test_args": dict(self._arguments),
            "launch_service": self._service,
        }
        for tests in (run.pre_shutdown_tests, run.post_shutdown_tests):
            run.bind(tests, given)
        keeper = [KeepAliveProc()] if run.markers.get("keep_alive") else []
        source = LaunchDescriptionSource(launch_description=description)
        include = IncludeLaunchDescription(source, launch_arguments=self._arguments)
        entities: list[LaunchDescriptionEntity] = [*self._handlers(), include, *keeper]
        self._service.include_launch_description(LaunchDescription(entities))
        thread = threading.Thread(target=self._test, daemon=True)
        thread.start()
        code = self._service.run()
        self._is_ready.set()  # whoever waits for it waits in vain
        thread.join()
        if self._active is None:
            result = _result_of(unittest.TestSuite())
            text = self._problem or "Processes under test stopped before tests completed"
            case = unittest.FunctionTestCase(lambda: None, description=str(run))
            result.failures.append((case, f"{text}\n{self._summary()}"))
            return result
        if code:
            case = unittest.FunctionTestCase(lambda: None, description=str(run))
            self._active.errors.append((case, "the launch description has a mistake: the output says which"))
        self._active.append(_result_of(run.post_shutdown_tests))
        return self._active

    def _handlers(self) -> list[RegisterEventHandler]:
        return [
            RegisterEventHandler(OnProcessStart(on_start=lambda event, _: self._info.append(event))),
            RegisterEventHandler(OnProcessExit(on_exit=lambda event, _: self._info.append(event))),
            RegisterEventHandler(
                OnProcessIO(
                    on_stdout=self._output.append,
                    on_stderr=self._output.append,
                )
            ),
        ]

    def _test(self) -> None:
        try:
            if not self._is_ready.wait(self._run.timeout):
                self._problem = f"Timed out waiting for processes to start up ({self._run.timeout:g} s)"
            elif not self._service.context.is_shutdown:
                self._active = _result_of(self._run.pre_shutdown_tests)
        finally:
            self._service.shutdown()

    def _summary(self) -> str:
        lines: list[str] = []
        for event in self._info:
            if getattr(event, "returncode", 0):
                lines.append(f"Process '{event.process_name}' exited with {event.returncode}; its output:")
                for each in self._output:
                    if each.action is event.action:
                        lines += each.text.decode(errors="replace").splitlines()
        return "\n".join(lines)


def _result_of(tests: unittest.TestSuite) -> TestResult:
    kind: Any = TestResult
    result = unittest.TextTestRunner(verbosity=2, resultclass=kind).run(tests)
    assert isinstance(result, TestResult), "the runner makes one"
    return result
