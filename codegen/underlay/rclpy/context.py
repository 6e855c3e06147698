"""Contexts: what happens between `init` and `shutdown`."""

from __future__ import annotations

import atexit
import os
import sys
import threading
import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager
from types import MethodType, TracebackType
from typing import TYPE_CHECKING, Any, Protocol
from weakref import WeakMethod, WeakSet

from rclpy.destroyable import DestroyableType
from rclpy.impl import distro, program
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rclpy.node import _BaseNode as BaseNode


class ContextHandle(DestroyableType, Protocol):
    """The client library's side of a context."""

    def ok(self) -> bool:
        """Whether it is up."""
        ...

    def get_domain_id(self) -> int:
        """The domain."""
        ...

    def shutdown(self) -> None:
        """Make it invalid."""
        ...


# Logging is set up by a program's first context that is initialised and ends with the last one.
g_logging_configure_lock = threading.Lock()


def __getattr__(name: str) -> Any:
    if name == "g_logging_ref_count":  # what upstream counts here
        return program.current().logging_users
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class Context(AbstractContextManager["Context"]):
    """One life from `init` to `shutdown`. It is not used again afterwards.

    As a context manager it initialises itself with the process's arguments and shuts down at the end.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()  # a shutdown callback may look at the context, as may a signal handler
        self._callbacks: list[WeakMethod[MethodType] | Callable[[], object]] = []
        self._logging_initialized = False
        self._nodes: WeakSet[BaseNode] = WeakSet()
        self.__context: _rclpy.Context | None = None

    @property
    def handle(self) -> Any:
        """The client library's side; None before `init`."""
        return self.__context

    def destroy(self) -> None:
        """Let go of the handle."""
        if self.__context is not None:
            self.__context.destroy_when_not_in_use()

    def init(
        self,
        args: list[str] | None = None,
        *,
        initialize_logging: bool = True,
        domain_id: int | None = None,
    ) -> None:
        """Start it.

        :param args: the command line; None for the program's own.
        :param initialize_logging: apply the log levels and switches among the arguments.
        :param domain_id: the domain; None for ROS_DOMAIN_ID, else 0.
        :raises RuntimeError: if it was initialised before, or the domain is negative.
        """
        with self._lock:
            if domain_id is not None and domain_id < 0:
                raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
            if self.__context is not None:
                raise RuntimeError("Context.init() must only be called once")
            self.__context = _rclpy.Context(
                sys.argv if args is None else args,
                _rclpy.RCL_DEFAULT_DOMAIN_ID if domain_id is None else domain_id,
            )
            if initialize_logging and not self._logging_initialized:
                self._logging_init()
        _initialised.add(self)

    def ok(self) -> bool:
        """Return whether it is initialised and not shut down."""
        handle = self.__context
        return handle is not None and handle.ok()

    def shutdown(self) -> None:
        """Shut it down and call what `on_shutdown` was given.

        :raises RuntimeError: if it is not initialised or was shut down before.
        """
        if self.__context is None:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if distro.follows("node_shutdown"):
            self._destroy_nodes()
        try:
            with self.__context, self._lock:
                self.__context.shutdown()
                self._logging_fini()
        finally:
            self._call_back()

    def try_shutdown(self) -> None:
        """Shut it down if it is up."""
        if self.__context is None:
            return
        if distro.follows("node_shutdown"):
            self._destroy_nodes()
        with self.__context, self._lock:
            if self.__context.ok():
                self.__context.shutdown()
            self._logging_fini()  # also after a signal
        self._call_back()

    def track_node(self, node: BaseNode) -> None:
        """Destroy a node, which is held weakly, when this shuts down; nodes do this themselves."""
        distro.uses("track_node")
        self._nodes.add(node)

    def untrack_node(self, node: BaseNode) -> None:
        """Take back `track_node`."""
        distro.uses("track_node")
        self._nodes.discard(node)

    def _destroy_nodes(self) -> None:
        """Destroy the nodes that are left, as newer ROS does before the callbacks of `on_shutdown`."""
        for node in list(self._nodes):
            node.destroy_node()

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Call this at shutdown, or now if that has been.

        After Ctrl-C or SIGTERM the thread that spins calls it, or else `shutdown`, `try_shutdown` or the end
        of the program. Upstream does not call it then. Bound methods are held weakly, functions strongly.
        """
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        with self._lock:
            if self.__context is None or self.ok():
                held = (
                    WeakMethod(callback, self._remove_callback)
                    if isinstance(callback, MethodType)
                    else callback
                )
                self._callbacks.append(held)
                return
        callback()

    def get_domain_id(self) -> int:
        """Return the domain."""
        if self.__context is None:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        with self.__context, self._lock:
            return self.__context.get_domain_id()

    def __enter__(self) -> Context:
        if self.ok() or (self.__context is not None and distro.follows("context_init")):
            distro.uses("Context")
            return self
        if distro.follows("context_init"):
            warnings.warn(
                "init() must be called on a Context before using it in a Python context manager. "
                "Calling init() implicitly is deprecated",
                stacklevel=2,
            )
        self.init()
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.try_shutdown()

    def _remove_callback(self, weak_method: WeakMethod[MethodType]) -> None:
        with self._lock:
            if weak_method in self._callbacks:
                self._callbacks.remove(weak_method)

    def _call_back(self) -> None:
        """Call once what `on_shutdown` was given, if it was shut down, by a signal perhaps."""
        if self.ok():
            return
        with self._lock:
            callbacks, self._callbacks = self._callbacks, []
        _call(callbacks)

    def _logging_init(self) -> None:
        here = program.current()
        with g_logging_configure_lock:
            here.logging_users += 1
            if here.logging_users == 1:
                assert self.__context is not None
                _rclpy.rclpy_logging_configure(self.__context)
        self._logging_initialized = True

    def _logging_fini(self) -> None:
        here = program.current()
        if not self._logging_initialized:
            return
        with g_logging_configure_lock:
            here.logging_users -= 1
            if here.logging_users == 0:
                _rclpy.rclpy_logging_fini()
        self._logging_initialized = False


def _call(callbacks: list[WeakMethod[MethodType] | Callable[[], object]]) -> None:
    """Call all of them, then raise what the first of them raised that failed."""
    faults: list[Exception] = []
    for held in callbacks:
        callback = held() if isinstance(held, WeakMethod) else held
        if callback is not None:
            try:
                callback()
            except Exception as error:
                faults.append(error)
    if faults:
        raise faults[0]


def _call_back_at_exit() -> None:
    for context in list(_initialised):
        if context.handle is not None and not context.ok():  # a signal has ended it, and nobody has noticed
            context._call_back()


def _start_over_in_fork() -> None:
    global g_logging_configure_lock  # noqa: PLW0603 - a thread that is not in the fork may have held the other one
    g_logging_configure_lock = threading.Lock()
    _initialised.clear()  # the end of the fork is not that of the program that was forked


_initialised: WeakSet[Context] = WeakSet()
atexit.register(_call_back_at_exit)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_start_over_in_fork)
