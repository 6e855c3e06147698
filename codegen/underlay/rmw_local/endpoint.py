"""The common part of readers, writers, clients and servers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rmw_local.status import IncompatibleQosStatus, IncompatibleTypeStatus, MatchedStatus

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.qos import QosProfile


class Endpoint:
    """One end of a topic. Its QoS profile is resolved: no policy is "system default" any more."""

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        self.node = node
        self.message_type = message_type
        self.topic = topic
        self.qos = qos
        self.gid = node.participant.next_gid()
        self.closed = False
        self.matched = MatchedStatus()
        self.incompatible_qos = IncompatibleQosStatus()
        self.incompatible_type = IncompatibleTypeStatus()
        # The reasons why earlier counterparts use another definition of the type, for the creator to log.
        self.type_conflicts: list[str] = []
