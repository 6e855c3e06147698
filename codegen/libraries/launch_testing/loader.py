# Tests and descriptions are the users', of any type.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""The tests of a module: its launches, with their arguments, and the cases during and after each."""

from __future__ import annotations

import functools
import inspect
import unittest
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from launch import LaunchDescription, LaunchDescriptionEntity

from launch_testing.actions import ReadyToTest

__all__ = [
    "LoadTestsFromPythonModule",
    "TestRun",
    "parametrize",
    "post_shutdown_test",
    "ready_to_test_action_timeout",
]

Description = Callable[..., Any]


def post_shutdown_test() -> Callable[[type[unittest.TestCase]], type[unittest.TestCase]]:
    """Return a decorator of a class of tests that run when all processes have ended."""

    def decorate(test_item: type[unittest.TestCase]) -> type[unittest.TestCase]:
        if not isinstance(test_item, type):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
            raise TypeError("post_shutdown_test decorates classes of tests")
        setattr(test_item, "__post_shutdown_test__", True)  # noqa: B010 - TestCase has none
        return test_item

    return decorate


def ready_to_test_action_timeout(timeout: float) -> Callable[[Description], Description]:
    """Return a decorator: the processes must be ready within `timeout` [s], by default 15."""

    def decorate(description: Description) -> Description:
        setattr(description, "__ready_to_test_action_timeout__", timeout)  # noqa: B010 - a function has none
        return description

    return decorate


def parametrize(
    argnames: str | Sequence[str], argvalues: Iterable[Any]
) -> Callable[[Description], Description]:
    """Return a decorator: a launch for each of these values of one argument, or for each tuple of several."""
    names = [name.strip() for name in argnames.split(",")] if isinstance(argnames, str) else list(argnames)
    values = [each if len(names) > 1 else (each,) for each in argvalues]
    sets = [dict(zip(names, each, strict=True)) for each in values]

    def decorate(description: Description) -> Description:
        setattr(description, "__parametrized__", sets)  # noqa: B010 - a function has none
        return description

    return decorate


class TestRun:
    """One launch, with the tests that run beside it and after it."""

    __test__ = False  # pytest takes it for a class of tests otherwise

    def __init__(
        self,
        name: str,
        test_description_function: Description,
        param_args: Mapping[str, Any],
        pre_shutdown_tests: unittest.TestSuite,
        post_shutdown_tests: unittest.TestSuite,
    ) -> None:
        self.name = name
        self.function = test_description_function
        self.param_args = dict(param_args)
        self.pre_shutdown_tests = pre_shutdown_tests
        self.post_shutdown_tests = post_shutdown_tests
        self.timeout = float(getattr(test_description_function, "__ready_to_test_action_timeout__", 15.0))

    @property
    def markers(self) -> dict[str, Any]:
        """The marks of `launch_testing.markers`."""
        return dict(getattr(self.function, "__markers__", {}))

    def describe(self, ready: Callable[[], None]) -> tuple[LaunchDescription, dict[str, Any]]:
        """Return the description, and what it gives to the tests; `ready` is called when they begin.

        Raises TypeError for a function that wants other arguments, or returns something else.
        """
        known = inspect.signature(self.function).parameters
        given = dict(self.param_args)
        if "ready_fn" in known:  # of older tests, which call it themselves
            given["ready_fn"] = ready
        try:
            inspect.signature(self.function).bind(**given)
        except TypeError as error:
            raise TypeError(f"generate_test_description: {error}") from None
        result = self.function(**given)
        description, context = result if isinstance(result, tuple) else (result, {})
        if not isinstance(description, LaunchDescription):
            raise TypeError(f"generate_test_description must return a LaunchDescription, got {result!r}")
        actions = [each for each in _entities(description) if isinstance(each, ReadyToTest)]
        if not actions and "ready_fn" not in known:
            raise TypeError(
                "generate_test_description functions must return a LaunchDescription containing a "
                "ReadyToTest action"
            )
        for action in actions[:1]:
            action.add_callback(ready)
        return description, context

    def bind(self, tests: unittest.TestSuite, arguments: Mapping[str, Any]) -> None:
        """Give the tests what their methods name, and the attributes `proc_info` and so on."""
        cases = list(all_cases(tests))
        for case in cases:
            for name in (case._testMethodName, "setUp", "tearDown"):
                setattr(case, name, _bound(getattr(case, name), arguments))
        for kind in {type(case) for case in cases}:
            for name, value in arguments.items():
                if not hasattr(kind, name):
                    setattr(kind, name, value)
            for name in ("setUpClass", "tearDownClass"):
                setattr(kind, name, _bound(getattr(kind, name), arguments))

    def __str__(self) -> str:
        """Return the name, with the arguments."""
        values = ", ".join(map(str, self.param_args.values()))
        return f"{self.name}[{values}]" if values else self.name


def LoadTestsFromPythonModule(module: Any, *, name: str = "launch_tests") -> list[TestRun]:
    """Return a run for each launch of a module. Raises AttributeError if it describes none."""
    function: Description = module.generate_test_description
    return [
        TestRun(name, function, arguments, _suite(module, is_after=False), _suite(module, is_after=True))
        for arguments in getattr(function, "__parametrized__", [{}])
    ]


def all_cases(suite: Iterable[Any]) -> Iterator[Any]:
    """Return the cases in suites within suites."""
    for each in suite:
        if isinstance(each, unittest.TestSuite):
            yield from all_cases(each)
        else:
            yield each


def _suite(module: Any, *, is_after: bool) -> unittest.TestSuite:
    loader = unittest.TestLoader()
    found = unittest.TestSuite()
    for each in vars(module).values():
        is_case = isinstance(each, type) and issubclass(each, unittest.TestCase)
        if is_case and getattr(each, "__post_shutdown_test__", False) is is_after:
            # A class of its own for each launch: what is bound to it must not reach the next one.
            own = type(each.__name__, (each,), {"__module__": each.__module__})
            found.addTest(loader.loadTestsFromTestCase(own))
    return found


def _entities(entity: LaunchDescriptionEntity) -> Iterator[LaunchDescriptionEntity]:
    yield entity
    for each in entity.describe_sub_entities():
        yield from _entities(each)
    for _, inside in entity.describe_conditional_sub_entities():
        for each in inside:
            yield from _entities(each)


def _bound(function: Callable[..., Any], arguments: Mapping[str, Any]) -> Callable[..., Any]:
    known = inspect.signature(function).parameters
    given = {name: value for name, value in arguments.items() if name in known}
    return functools.partial(function, **given) if given else function
