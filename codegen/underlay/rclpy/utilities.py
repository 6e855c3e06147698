"""The default context, and small things around it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

from rclpy.constants import S_TO_NS
from rclpy.context import Context
from rclpy.impl import program
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

g_context_lock = program.current().lock


def __getattr__(name: str) -> Any:
    if name == "g_default_context":
        return program.current().default_context
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context that is meant where none is given.

    :param shutting_down: the next call gets a new one.
    """
    here = program.current()
    context = here.default_context
    if context is not None and not shutting_down:
        return context
    with here.lock:
        context = here.default_context
        if context is None:
            context = Context()
        here.default_context = None if shutting_down else context
        return context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return the arguments that are not ROS's.

    :param args: a command line; None for the program's own.
    """
    return _rclpy.rclpy_remove_ros_args(sys.argv if args is None else args)


def ok(*, context: Context | None = None) -> bool:
    """Return whether a context (None: the default one) is initialised and not shut down."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut down a context (None: the default one).

    :raises RuntimeError: if it is not initialised or was shut down before.
    """
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut down a context (None: the default one) if it is up."""
    if context is not None:
        context.try_shutdown()
        return
    default = get_default_context()
    default.try_shutdown()
    here = program.current()
    with here.lock:
        if here.default_context is default:
            here.default_context = None


def get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware."""
    return _rclpy.rclpy_get_rmw_implementation_identifier()


def get_available_rmw_implementations() -> set[str]:
    """Return the names of the middlewares that could be used: there is one."""
    return {get_rmw_implementation_identifier()}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a timeout [s] to ns; None and negative ones, which mean "no limit", to -1."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return int(float(timeout_sec) * S_TO_NS)
