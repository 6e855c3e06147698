"""Action clients and servers that refuse others with another definition.

Adapters convert messages, and the graph of DDS has the hashes of what an action wraps them in. So nothing is
adapted here: a node that would adapt refuses.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import Any

from ifgen_runtime.mismatch.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.mismatch.real_rclpy.graph import Peer
from ifgen_runtime.mismatch.real_rclpy.others import Others
from ifgen_runtime.mismatch.real_rclpy.taking import key_of, participant_of


class ActionGuard:
    """Knows the definitions of others, each by its participant of DDS, which is what a request tells."""

    def __init__(self, node: Any, parts: tuple[Part, ...]) -> None:
        self._others = [Others(node, part, participant_of) for part in parts]

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all who are there now."""
        found = tuple(others)
        for known in self._others:
            known.see(peer for part, peer in found if part == known.part)

    def end(self) -> None:
        """Nothing is left to end."""

    def look(self) -> None:
        """Take note of all who are there now. Raises InvalidHandle where the node has been destroyed."""
        for known in self._others:
            known.look()

    def all_agree(self) -> bool:
        """Whether all who were there at the last look have our definition."""
        return all(known.hashes <= {known.part.type_hash} for known in self._others)

    def agrees(self, request_id: Any) -> bool:
        """Whether the client that a request has come from has our definition in all parts.

        It may be discovered part by part. What a request is sent with is there before the request.
        """
        client = participant_of(key_of(request_id))
        hashes = [(known.part.type_hash, known.hash_of(client)) for known in self._others]
        return any(ours == found for ours, found in hashes) and all(
            found in {ours, None} for ours, found in hashes
        )


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
        self._guard.look()
        return bool(self._plain.is_action_server_available()) and self._guard.all_agree()

    def send_goal_request(self, request: Any) -> int:
        """Send a goal, and return its number. One that is refused is as one without a server."""
        self._guard.look()
        number = self._plain.send_goal_request(request) if self._guard.all_agree() else next(self._unsent)
        return int(number)

    def take_goal_response(self, response_type: type[Any]) -> Any:
        """The number and the next response; None twice if there is none to deliver."""
        return self._if_all_agree(self._plain.take_goal_response(response_type))

    def take_result_response(self, response_type: type[Any]) -> Any:
        """The number and the next response; None twice if there is none to deliver."""
        return self._if_all_agree(self._plain.take_result_response(response_type))

    def take_feedback(self, feedback_type: type[Any]) -> Any:
        """The next feedback; None if there is none to deliver.

        A goal is sent to servers of our definition only, and rclpy drops feedback of others.
        """
        feedback = self._plain.take_feedback(feedback_type)
        return feedback if self._guard.all_agree() else None

    def _if_all_agree(self, taken: Any) -> Any:
        self._guard.look()
        return taken if self._guard.all_agree() else (None, None)


def guard_action(node: Any, waitable: Any, role: str, name: str, cls: type[Any]) -> ActionGuard:
    """Put a guard before rclpy's ActionClient or ActionServer, which has just been made."""
    guard = ActionGuard(node, parts_of(role, name, cls, None))
    if role == "action client":
        waitable._client_handle = _GuardedHandle(waitable._client_handle, guard)
    else:
        waitable.take_data = _guarded(waitable.take_data, guard)
    return guard


def _guarded(take_data: Callable[[], dict[str, Any]], guard: ActionGuard) -> Callable[[], dict[str, Any]]:
    """Of what a server takes, leave out goals and requests for results of clients that differ."""

    def take_guarded() -> dict[str, Any]:
        taken = take_data()
        for kind in ("goal", "result"):
            if kind in taken and not guard.agrees(taken[kind][0]):
                del taken[kind]
        return taken

    return take_guarded
