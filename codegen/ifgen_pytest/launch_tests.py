"""Collects launch tests: modules whose `generate_test_description` is marked as `launch_test`."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from ifgen_pytest.domains import RANGE, own_domain

_UPSTREAM = "launch_testing"  # the name of the plugin that a ROS registers
_FUNCTION = "generate_test_description"


def add_option(parser: pytest.Parser) -> None:
    """Declare `--launch-args`, unless launch_testing of a ROS has declared it."""
    with suppress(ValueError):
        parser.addoption(
            "--launch-args", action="append", nargs="*", default=[], help="NAME:=VALUE for launch tests"
        )


class LaunchTestFailure(Exception):
    """Some tests of a launch have failed; the text has their tracebacks."""


class LaunchTestItem(pytest.Item):
    """All launches of a module, with their tests."""

    runs: Any = ()

    def runtest(self) -> None:
        """Run them. Raises LaunchTestFailure."""
        runner_module: Any = import_module("launch_testing.test_runner")
        words = [word for words in self.config.getoption("--launch-args") for word in words]
        runner = runner_module.LaunchTestRunner(copy.copy(self.runs), words)
        with ExitStack() as kept, pytest.MonkeyPatch.context() as patch:
            if os.environ.get(RANGE) == "OFF":  # as the plugin sets it; the processes are to meet this one
                patch.setenv(RANGE, "LOCALHOST")
                if "ROS_DOMAIN_ID" not in os.environ:
                    patch.setenv("ROS_DOMAIN_ID", str(kept.enter_context(own_domain())))
            runner.validate()
            results = runner.run()
        failed = [each for result in results.values() for each in (*result.errors, *result.failures)]
        if failed or not all(result.wasSuccessful() for result in results.values()):
            raise LaunchTestFailure("\n".join(f"FAIL: {case}\n{text}" for case, text in failed))
        if results and all(result.skipped and not result.testsRun for result in results.values()):
            pytest.skip(next(iter(results.values())).skipped[0][1])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the tracebacks of the tests."""
        if isinstance(excinfo.value, LaunchTestFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Return the place of the module."""
        return self.path, 0, f"launch tests: {self.name}"


class LaunchTestModule(pytest.Module):
    """A module of launch tests, which is one item."""

    def collect(self) -> Iterator[LaunchTestItem]:
        """Return the item."""
        loader: Any = import_module("launch_testing.loader")
        item = LaunchTestItem.from_parent(self, name=self.path.stem)
        item.runs = loader.LoadTestsFromPythonModule(self.obj, name=self.path.stem)
        yield item


@pytest.hookimpl(tryfirst=True)
def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Take a module whose function has the mark; a file that does not name it is not imported."""
    if (
        parent.config.pluginmanager.has_plugin(_UPSTREAM)
        or _FUNCTION.encode() not in module_path.read_bytes()
    ):
        return None
    module = LaunchTestModule.from_parent(parent, path=module_path)
    marks = getattr(getattr(module.obj, _FUNCTION, None), "pytestmark", ())
    return module if any(mark.name == "launch_test" for mark in marks) else None
