"""The common part of readers, writers, clients and servers."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from rmw_local.status import IncompatibleQosStatus, IncompatibleTypeStatus, MatchedStatus

if TYPE_CHECKING:
    from rmw_local.encounter import Encounter
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.qos import QosProfile


class Endpoint:
    """One end of a topic. Its QoS profile is resolved: no policy is "system default" any more."""

    role: ClassVar[str]
    is_remote: ClassVar[bool] = False
    """Whether it stands for an endpoint in another process."""
    encounters: tuple[Encounter, ...] = ()  # with other definitions, until they are told of

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

    @property
    def kind(self) -> MessageType:
        """Its type, as services and topics both have one."""
        return self.message_type

    @property
    def name(self) -> str:
        """The name of its topic."""
        return self.topic
