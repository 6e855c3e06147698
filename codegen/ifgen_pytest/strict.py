"""Strict mode: what goes by silently in a running robot, and should not in a test.

Exceptions and definitions that differ are watched on both transports; nodes, messages, QoS and synchronous
calls on the local one, which can be looked into (`rmw_local.observer`).
"""

from __future__ import annotations

import importlib
import inspect
import sys
import threading
import traceback
from collections import Counter
from collections.abc import Callable
from typing import Any

# Nodes publish on these by themselves; they need no listener.
_BACKGROUND = ("/rosout", "/parameter_events")
_BACKGROUND_ENDINGS = ("/_action/status", "/_action/feedback", "/transition_event", "/_service_event")


class StrictCheck:
    """Watches a test from its making until `end`."""

    def __init__(self) -> None:
        self._errors: list[tuple[str, BaseException]] = []  # with the callback or thread that raised them
        self._futures: list[Any] = []  # those that ended with an exception
        self._told: list[BaseException] = []
        self._undo: list[tuple[Any, str, Any]] = []
        self._findings = TransportRecord()
        self._mismatches: dict[Any, Any] = {}  # pairs of endpoints whose definitions differ
        self._exchange(threading, "excepthook", self._on_thread_error)
        self._watch_rclpy()

    def _watch_rclpy(self) -> None:
        try:
            task = importlib.import_module("rclpy.task")
        except ImportError:
            return  # a test without ROS
        futures, set_exception = self._futures, task.Future.set_exception

        def set_and_note(future: Any, exception: BaseException) -> None:
            set_exception(future, exception)
            futures.append(future)

        self._exchange(task.Future, "set_exception", set_and_note)
        self._watch_actions()
        self._watch_definitions()
        try:
            observer = importlib.import_module("rmw_local.observer")
            blocking = importlib.import_module("rclpy.impl.blocking")
            distro = importlib.import_module("rclpy.impl.distro")
        except ImportError:
            return  # the real rclpy
        self._exchange(blocking, "enabled", True)
        self._exchange(distro, "strict", True)  # newer API than that of the chosen ROS is an error
        self._undo.append((observer._Current, "observer", observer.install(self._findings)))

    def _watch_definitions(self) -> None:
        """Note endpoints whose definitions differ; nobody compares them without generated messages."""
        try:
            reporting = importlib.import_module("ifgen_runtime.mismatch.reporting")
        except ImportError:
            return
        self._exchange(reporting, "listener", self._on_mismatch)

    def _watch_actions(self) -> None:
        """Note what goals raise: an action server only logs it, and aborts the goal."""
        server = sys.modules.get("rclpy.action.server")
        if server is None:
            return
        execute_goal, errors = server.ActionServer._execute_goal, self._errors

        async def execute_and_note(self: Any, callback: Callable[..., Any], goal_handle: Any) -> None:
            async def noting(*arguments: Any) -> Any:
                try:
                    result = callback(*arguments)
                    return await result if inspect.isawaitable(result) else result
                except Exception as error:
                    errors.append(("a goal's execution", error))
                    raise

            await execute_goal(self, noting, goal_handle)

        self._exchange(server.ActionServer, "_execute_goal", execute_and_note)

    def errors(self) -> str:
        """Unhandled exceptions of callbacks and threads. Each is reported once."""
        found = list(self._errors)
        found += [
            ("a callback", future._exception) for future in self._futures if not future._exception_fetched
        ]
        texts: list[str] = []
        for where, error in found:
            if not any(error is known for known in self._told):
                self._told.append(error)
                texts.append(f"ros_strict: {where} raised\n{''.join(traceback.format_exception(error))}")
        for future in self._futures:
            future.exception()  # now somebody has looked; it prints nothing when it goes
        return "\n".join(texts).rstrip()

    def left_over(self) -> str:
        """Everything else that is wrong, a line each."""
        lines = [*self._findings.report(), *self._differing()]
        return "\n".join(f"ros_strict: {line}" for line in lines)

    def _differing(self) -> list[str]:
        """A text for each mismatch."""
        if not self._mismatches:
            return []
        explain = importlib.import_module("ifgen_runtime.mismatch.reporting").explanation
        return [explain(mismatch) for mismatch in self._mismatches.values()]

    def end(self) -> None:
        """Watch no more."""
        for owner, name, before in reversed(self._undo):
            setattr(owner, name, before)
        self._undo.clear()

    def _exchange(self, owner: Any, name: str, new: Any) -> None:
        self._undo.append((owner, name, getattr(owner, name)))
        setattr(owner, name, new)

    def _on_mismatch(self, mismatch: Any) -> None:
        """Keep one of each kind, unless an adapter does what the test wants."""
        mine, theirs = mismatch.mine, mismatch.theirs
        if mismatch.policy != "adapt":
            key = (mismatch.name, mine.node, theirs.node, mine.type_hash, theirs.type_hash)
            self._mismatches.setdefault(key, mismatch)

    def _on_thread_error(self, info: threading.ExceptHookArgs) -> None:
        # A thread that spins ends like this when its context is shut down.
        if info.exc_value is not None and info.exc_type.__name__ != "ExternalShutdownException":
            name = info.thread.name if info.thread is not None else "that is gone"
            self._errors.append((f"thread {name}", info.exc_value))


class TransportRecord:
    """An `rmw_local.observer.Observer` that keeps what a test should know."""

    def __init__(self) -> None:
        self._undelivered: Counter[tuple[str, str]] = Counter()
        self._incompatible: dict[str, None] = {}
        self._nodes: dict[int, Any] = {}  # opened and not closed, by id

    def undelivered(self, topic: str, count: int, why: str) -> None:
        """Count messages that will never be read, except on background topics."""
        if topic not in _BACKGROUND and not topic.endswith(_BACKGROUND_ENDINGS):
            self._undelivered[topic, why] += count

    def incompatible_qos(self, topic: str, policy_kind: int, writer_node: str, reader_node: str) -> None:
        """Note two endpoints whose QoS does not match."""
        from rclpy.qos import QoSPolicyKind  # imported when a test asks

        policy = QoSPolicyKind(policy_kind).name
        reason = f"{writer_node} does not offer the {policy} that {reader_node} requests"
        self._incompatible[f"incompatible QoS on {topic}: {reason}"] = None

    def incompatible_type(self, topic: str, explanation: str) -> None:
        """Note two endpoints whose types do not match."""
        self._incompatible[f"incompatible types on {topic}: {explanation}"] = None

    def opened(self, entity: Any) -> None:
        """Remember an open node."""
        if _is_node(entity):
            self._nodes[id(entity)] = entity

    def closed(self, entity: Any) -> None:
        """Forget a closed node."""
        self._nodes.pop(id(entity), None)

    def report(self) -> list[str]:
        """A line for each finding."""
        leaks = [f"node {node.full_name} was not destroyed" for node in self._nodes.values()]
        lost = [f"{count} undelivered on {topic}: {why}" for (topic, why), count in self._undelivered.items()]
        return [*leaks, *self._incompatible, *lost]


def _is_node(entity: Any) -> bool:
    return hasattr(entity, "full_name")
