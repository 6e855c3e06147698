"""Marks of the function `generate_test_description`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

__all__ = ["keep_alive", "launch_test", "retry_on_failure"]

_Function = TypeVar("_Function", bound=Callable[..., Any])


def keep_alive(test_description: _Function) -> _Function:
    """Keep the launch alive until the tests end, also when all processes have ended."""
    marks: dict[str, Any] = getattr(test_description, "__markers__", {})
    setattr(test_description, "__markers__", {**marks, "keep_alive": True})  # noqa: B010 - a function has none
    return test_description


def retry_on_failure(*, times: int, delay: float | None = None) -> Callable[[_Function], _Function]:
    """Return a decorator that runs a test again when an assertion fails, until it has run `times` times."""
    import time  # of a test that is run again
    from functools import wraps

    def decorate(function: _Function) -> _Function:
        @wraps(function)
        def run(*args: Any, **kwargs: Any) -> Any:
            for left in range(times - 1, -1, -1):
                try:
                    return function(*args, **kwargs)
                except AssertionError:
                    if not left:
                        raise
                    time.sleep(delay or 0.0)
            raise ValueError(f"a test must run once at least, got {times} times")

        return run  # type: ignore[return-value]  # it has the signature

    return decorate


def launch_test(test_description: _Function) -> _Function:
    """Mark a function of a module as that of launch tests; `pytest.mark.launch_test` does the same."""
    import pytest  # who runs a file without it has none

    return pytest.mark.launch_test(test_description)  # type: ignore[no-any-return]  # as pytest types it
