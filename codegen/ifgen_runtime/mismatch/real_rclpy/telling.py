"""Says once for each pair of endpoints that their definitions differ."""

from __future__ import annotations

import threading
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from typing import Any, Final

from rclpy.logging import get_logger

from ifgen_runtime.mismatch import listeners
from ifgen_runtime.mismatch.explanation import explanation, in_one_line
from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.real_rclpy.endpoints import Endpoint, Part
from ifgen_runtime.mismatch.real_rclpy.graph import Peer
from ifgen_runtime.mismatch.remembered import Once
from ifgen_runtime.mismatch.sides import Definition, Mismatch, Side, definition_of
from ifgen_runtime.mismatch.told import Say, Told
from ifgen_runtime.mismatch.type_description_client import Definitions, Question, node_connection

_NAMELESS: Final = "a node without a name"

_ASKING: Final = "_ifgen_type_mismatch"
"""The name of the hidden node that asks others, and exists only while questions are open."""

_POLL: Final = 0.02
"""Seconds between two looks at whether a node can be asked."""


@dataclass(frozen=True, slots=True)
class Meeting:
    """One of our endpoints, and another whose definition of a part differs, or is not known.

    `policy` is what our endpoint's node does about it.
    """

    endpoint: Endpoint
    part: Part
    peer: Peer
    policy: OnTypeMismatch

    @property
    def key(self) -> Hashable:
        """The pair that is told of once. If both are in this process, either may be the one that looks."""
        endpoint, peer = self.endpoint, self.peer
        if not peer.type_hash:
            return self.part.type_name
        nodes = frozenset({(endpoint.node_name, endpoint.role), (peer.node, endpoint.others)})
        return endpoint.name, nodes, frozenset({self.part.type_hash, peer.type_hash})

    @property
    def question(self) -> Question:
        """The question for the definition of the other."""
        return Question(self.peer.node, self.part.type_name, self.peer.type_hash)


class Teller:
    """Collects meetings, asks for the definitions of the others, and warns."""

    def __init__(self, context: Any, stop: threading.Event) -> None:
        self._definitions = Definitions(lambda: node_connection(context, _ASKING, _POLL), stop.is_set)
        self._seen = Once()
        self._told = Told()
        self._untold: list[Meeting] = []
        self._complaints: set[str] = set()

    def note(self, meeting: Meeting) -> None:
        """Tell of a meeting soon, unless its pair has been told."""
        if self._seen.is_new(meeting.key):
            self._untold.append(meeting)

    def tell(self, endpoints: Iterable[Endpoint]) -> None:
        """Tell of the meetings since the last time. `endpoints` are all that this process has."""
        meetings, self._untold = self._untold, []
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
                    _tell_of_no_hash(meeting)
                elif meeting.peer.type_hash in here:
                    self._tell(meeting, definition_of(here[meeting.peer.type_hash]))
                else:
                    self._tell(meeting, self._definitions.get(meeting.question))
            except Exception as error:  # such as a node that has been destroyed meanwhile
                self.complain(error)

    def _tell(self, meeting: Meeting, theirs: Definition | None) -> None:
        """Tell listeners, and the user as often as `told` has it."""
        mismatch, endpoint = _mismatch(meeting, theirs), meeting.endpoint
        listeners.tell(mismatch)
        say = self._told.count(endpoint.name)
        logger = endpoint.node.get_logger()
        if say is Say.NO_MORE:
            logger.warning(
                f"{endpoint.kind} '{endpoint.name}': more endpoints differ, which is not said any more"
            )
        elif say is Say.ALL and mismatch.policy == OnTypeMismatch.ADAPT:
            logger.info(explanation(mismatch))
        elif say is Say.ALL:
            text = explanation(mismatch)
            if endpoint.policy is OnTypeMismatch.ADAPT and meeting.policy is OnTypeMismatch.REFUSE:
                reason = (
                    "Actions are not adapted on real rclpy"
                    if endpoint.kind == "action"
                    else "No adapter fits"
                )
                text += f"\n{reason}, so nothing is exchanged."
            if not endpoint.is_connected():
                text += "\nThe middleware has not connected them: nothing is delivered between them."
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


def _tell_of_no_hash(meeting: Meeting) -> None:
    meeting.endpoint.node.get_logger().info(in_one_line(_mismatch(meeting, None)))
