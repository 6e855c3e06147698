"""Action clients and servers that refuse others with another definition.

Adapters convert messages, and the graph of DDS has the hashes of what an action wraps them in. So nothing is
adapted here: a node that would adapt refuses.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable
from typing import Any

from ifgen_runtime.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.real_rclpy.peers import Others, Peer


class ActionGuard:
    """Knows the definitions of all servers, or of all clients: rclpy does not tell whose a goal is."""

    must_agree = True

    def __init__(self, node: Any, parts: tuple[Part, ...]) -> None:
        self._others = [Others(node, part) for part in parts]

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all who are there now."""
        found = tuple(others)
        for known in self._others:
            known.see(peer for part, peer in found if part == known.part)

    def end(self) -> None:
        """Nothing is left to end."""

    def all_agree(self, since: int | None = None) -> bool:
        """Whether all have our definition who are there, or were after `since` [ns, system time].

        Raises InvalidHandle where the node has been destroyed.
        """
        moment = time.time_ns() if since is None else since
        return not any(known.differed_since(moment) for known in self._others)


class _GuardedHandle:
    """The handle of an action client, with a guard before all that says something of a server."""

    def __init__(self, plain: Any, guard: ActionGuard) -> None:
        self._plain = plain
        self._guard = guard
        self._unsent = itertools.count(-1, -1)  # numbers of goals that nobody gets: below those of rcl

    def __getattr__(self, name: str) -> Any:
        return getattr(self._plain, name)

    def __enter__(self) -> Any:
        return self._plain.__enter__()

    def __exit__(self, *error: object) -> Any:
        return self._plain.__exit__(*error)

    def is_action_server_available(self) -> bool:
        """Whether a server is there, and none that is refused."""
        return bool(self._plain.is_action_server_available()) and self._guard.all_agree()

    def send_goal_request(self, request: Any) -> int:
        """Send a goal, and return its number. One that is refused is as one without a server."""
        return int(self._plain.send_goal_request(request) if self._guard.all_agree() else next(self._unsent))

    def take_goal_response(self, response_type: type[Any]) -> Any:
        """The number and the next response; None twice if there is none to deliver."""
        taken = self._plain.take_goal_response(response_type)
        return taken if self._guard.all_agree() else (None, None)

    def take_result_response(self, response_type: type[Any]) -> Any:
        """The number and the next response; None twice if there is none to deliver."""
        taken = self._plain.take_result_response(response_type)
        return taken if self._guard.all_agree() else (None, None)

    def take_feedback(self, feedback_type: type[Any]) -> Any:
        """The next feedback; None if there is none to deliver."""
        feedback = self._plain.take_feedback(feedback_type)
        return feedback if self._guard.all_agree() else None


class _GuardedServer:
    """The methods that an executor calls of a waitable, for an action server with a guard.

    rclpy does not tell when a goal has come. But nothing had where nothing was ready: what is taken later has
    come after the look before that.
    """

    def __init__(self, server: Any, guard: ActionGuard) -> None:
        self._is_ready: Callable[[Any], bool] = server.is_ready
        self._take_data: Callable[[], dict[str, Any]] = server.take_data
        self._guard = guard
        self._asked = self._idle = time.time_ns()

    def is_ready(self, wait_set: Any) -> bool:
        """Whether something has come."""
        is_ready, asked = self._is_ready(wait_set), self._asked
        self._asked = time.time_ns()
        if not is_ready:
            self._idle = asked
        return is_ready

    def take_data(self) -> dict[str, Any]:
        """All that has come, without goals and requests for results where clients differ."""
        taken = self._take_data()
        if not taken.keys().isdisjoint(("goal", "result")) and not self._guard.all_agree(self._idle):
            taken.pop("goal", None)
            taken.pop("result", None)
        return taken


def guard_action(node: Any, waitable: Any, role: str, name: str, cls: type[Any]) -> ActionGuard:
    """Put a guard before rclpy's ActionClient or ActionServer, which has just been made."""
    guard = ActionGuard(node, parts_of(role, name, cls, None))
    if role == "action client":
        waitable._client_handle = _GuardedHandle(waitable._client_handle, guard)
    else:
        server = _GuardedServer(waitable, guard)
        waitable.is_ready, waitable.take_data = server.is_ready, server.take_data
    return guard
