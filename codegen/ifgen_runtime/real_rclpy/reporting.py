"""Says what a look at the graph has found: once for each pair of endpoints whose definitions differ.

Besides, it says why received bytes did not fit their type: the C extension counts them.
"""

from __future__ import annotations

import threading
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from rclpy.logging import get_logger

from ifgen_runtime.field_types import type_name
from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.reporting import (
    Definition,
    Mismatch,
    SeenSet,
    Side,
    WarningLimit,
    definition_of,
    in_one_line,
    left_over,
    report,
)
from ifgen_runtime.mismatch.type_description_client import Definitions, Question, node_connection
from ifgen_runtime.real_rclpy import register
from ifgen_runtime.real_rclpy.endpoints import Endpoint, Part
from ifgen_runtime.real_rclpy.peers import Peer

_ASKING: Final = "_ifgen_type_mismatch"
"""The name of the hidden node that asks others, and exists only while questions are open."""

_POLL: Final = 0.02
"""Seconds between two looks at whether a node can be asked."""

_NAMELESS: Final = "a node without a name"


@dataclass(frozen=True, slots=True)
class Meeting:
    """One of our endpoints, and another whose definition of a part differs, or is not known.

    `policy` is what our endpoint's node does about it, and `reason` why that is not what it asked for.
    """

    endpoint: Endpoint
    part: Part
    peer: Peer
    policy: OnTypeMismatch
    reason: str = ""

    @property
    def key(self) -> Hashable:
        """The pair that is reported once. If both are in this process, either may be the one that looks."""
        endpoint, peer = self.endpoint, self.peer
        if not peer.type_hash:
            return self.part.type_name
        nodes = frozenset({(endpoint.node_name, endpoint.role), (peer.node, endpoint.others)})
        return endpoint.name, nodes, frozenset({self.part.type_hash, peer.type_hash}), self.policy

    @property
    def question(self) -> Question:
        """The question for the definition of the other."""
        return Question(self.peer.node, self.part.type_name, self.peer.type_hash)


class Reporter:
    """Collects meetings, asks for the definitions of the others, and warns."""

    def __init__(self, context: Any, stop: threading.Event) -> None:
        connect = partial(node_connection, context, _ASKING, _POLL)
        self._definitions = Definitions(connect, stop.is_set)
        self._seen = SeenSet()
        self._limit = WarningLimit()
        self._pending: list[Meeting] = []
        self._complaints: set[str] = set()

    def note(self, meeting: Meeting) -> None:
        """Report a meeting soon, unless its pair has been reported."""
        if self._seen.add(meeting.key):
            self._pending.append(meeting)

    def report(self, endpoints: Iterable[Endpoint]) -> None:
        """Report the meetings since the last time. `endpoints` are all that this process has."""
        meetings, self._pending = self._pending, []
        if not meetings:
            return
        here = {part.type_hash: part.cls for endpoint in endpoints for part in endpoint.parts}
        # Nodes answer for the hash of a service, and the graph has the hashes of its parts.
        self._definitions.ask(
            meeting.question
            for meeting in meetings
            if meeting.part.is_message and meeting.peer.type_hash not in here
        )
        for meeting in meetings:
            try:
                if not meeting.peer.type_hash:
                    _report_no_hash(meeting)
                elif meeting.peer.type_hash in here:
                    self._report(meeting, definition_of(here[meeting.peer.type_hash]))
                else:
                    self._report(meeting, self._definitions.get(meeting.question))
            except Exception as error:  # such as a node that has been destroyed meanwhile
                self.complain(error)

    def _report(self, meeting: Meeting, theirs: Definition | None) -> None:
        """Tell the listener, and log as the node of our endpoint."""
        endpoint = meeting.endpoint

        def remarks(_: str) -> str:
            text = f"\n{meeting.reason}, so nothing is exchanged." if meeting.reason else ""
            if meeting.policy is not OnTypeMismatch.ADAPT and not endpoint.is_connected():
                text += "\nThe middleware has not connected them: nothing is delivered between them."
            return text

        text = report(_mismatch(meeting, theirs), self._limit, remarks)
        logger = endpoint.node.get_logger()
        # Two lines: rclpy refuses another severity from the same one.
        if text and meeting.policy is OnTypeMismatch.ADAPT:
            logger.info(text)
        elif text:
            logger.warning(text)

    def complain(self, error: Exception) -> None:
        """Say once that something has failed, to whoever looks for it."""
        text = f"cannot compare definitions: {error!r}"
        if text in self._complaints:
            return
        self._complaints = {text}
        try:
            logger: Any = get_logger("ifgen")
            logger.debug(text)
        except Exception:  # rclpy is shutting down
            return


def _mismatch(meeting: Meeting, theirs: Definition | None) -> Mismatch:
    endpoint, part, peer = meeting.endpoint, meeting.part, meeting.peer
    return Mismatch(
        endpoint.kind,
        endpoint.name,
        part.type_name,
        meeting.policy.value,
        Side(endpoint.node_name, endpoint.role, part.type_hash, definition_of(part.cls)),
        Side(peer.node or _NAMELESS, endpoint.others, peer.type_hash, theirs),
    )


def _report_no_hash(meeting: Meeting) -> None:
    meeting.endpoint.node.get_logger().info(in_one_line(_mismatch(meeting, None)))


class UnreadableBytes:
    """Compares the counts of each class that is received with those of the last time."""

    def __init__(self) -> None:
        self._counts: dict[type[Any], tuple[int, int, int]] = {}
        self._said = SeenSet()

    def note(self, endpoint: Endpoint) -> None:
        """Watch the classes that an endpoint receives from now on."""
        for part in endpoint.parts:
            if not part.written and part.cls not in self._counts:
                self._counts[part.cls] = (0, 0, 0)

    def look(self, endpoints: Iterable[Endpoint]) -> None:
        """Say once for each endpoint, or for each of its senders that are known to differ, what is wrong."""
        for cls, before in tuple(self._counts.items()):
            now = register.troubles(cls)
            if now != before:
                self._counts[cls] = now
                self._tell(cls, before, now, endpoints)

    def _tell(
        self,
        cls: type[Any],
        before: tuple[int, int, int],
        now: tuple[int, int, int],
        endpoints: Iterable[Endpoint],
    ) -> None:
        dropped, with_rest, rest = now[0] - before[0], now[1] - before[1], now[2]
        receiving = [e for e in endpoints if any(p.cls is cls and not p.written for p in e.parts)]
        # One count is for all that receive the type: if somebody is known to differ, it is their messages.
        receiving = [endpoint for endpoint in receiving if endpoint.differing] or receiving
        for endpoint in receiving:
            of = " or ".join(endpoint.differing) or f"a {endpoint.others}"
            if dropped:
                messages = "a message" if dropped == 1 else f"{dropped} messages"
                self._say(endpoint, f"{messages} of {of} did not fit {type_name(cls)}, and were dropped")
            if with_rest:
                self._say(endpoint, left_over(rest, of, type_name(cls)), "rest")

    def _say(self, endpoint: Endpoint, text: str, kind: str = "dropped") -> None:
        node = endpoint.node
        if node is None or not self._said.add((endpoint.name, endpoint.role, kind, endpoint.differing)):
            return
        reason = "The definitions of the type differ"
        if not endpoint.differing:
            reason = "Probably they were made with another definition of the type"
        where = f"{endpoint.kind} '{endpoint.name}'"
        node.get_logger().warning(f"{where}: {text}. {reason}. This is said once.")
