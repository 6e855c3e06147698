"""Information of the graph about one publisher or subscription."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from rclpy.qos import HistoryPolicy as _HistoryPolicy
from rclpy.qos import QoSPresetProfiles, QoSProfile
from rclpy.type_hash import TypeHash


class TopicEndpointTypeEnum(IntEnum):
    """The kind of endpoint of a topic."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


TopicEndpointTypeEnum.__module__ = "rclpy.topic_endpoint_info"


class TopicEndpointInfo:
    """One publisher or subscription: its node, its type, its QoS profile and its gid (16 numbers).

    Raises AssertionError for unknown fields and values of a wrong type.
    """

    __module__ = "rclpy.topic_endpoint_info"
    __slots__ = [  # noqa: RUF023 - the order of the fields
        "_node_name",
        "_node_namespace",
        "_topic_type",
        "_topic_type_hash",
        "_endpoint_type",
        "_endpoint_gid",
        "_qos_profile",
    ]

    def __init__(self, **kwargs: Any) -> None:
        assert all(f"_{key}" in self.__slots__ for key in kwargs), (
            f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        )
        self.node_name = kwargs.get("node_name", "")
        self.node_namespace = kwargs.get("node_namespace", "")
        self.topic_type = kwargs.get("topic_type", "")
        self.topic_type_hash = kwargs.get("topic_type_hash", TypeHash())
        self.endpoint_type = kwargs.get("endpoint_type", TopicEndpointTypeEnum.INVALID)
        self.endpoint_gid = kwargs.get("endpoint_gid", [])
        self.qos_profile = kwargs.get("qos_profile", QoSPresetProfiles.UNKNOWN.value)

    @property
    def node_name(self) -> str:
        """The name of its node."""
        return self._node_name

    @node_name.setter
    def node_name(self, value: str) -> None:
        """Set it. Raises AssertionError for what is no str."""
        assert isinstance(value, str)
        self._node_name = value

    @property
    def node_namespace(self) -> str:
        """The namespace of its node."""
        return self._node_namespace

    @node_namespace.setter
    def node_namespace(self, value: str) -> None:
        """Set it. Raises AssertionError for what is no str."""
        assert isinstance(value, str)
        self._node_namespace = value

    @property
    def topic_type(self) -> str:
        """The type: `pkg/msg/Name`."""
        return self._topic_type

    @topic_type.setter
    def topic_type(self, value: str) -> None:
        """Set it. Raises AssertionError for what is no str."""
        assert isinstance(value, str)
        self._topic_type = value

    @property
    def topic_type_hash(self) -> TypeHash:
        """The hash of the type; can be set from the keyword arguments of a TypeHash."""
        return self._topic_type_hash

    @topic_type_hash.setter
    def topic_type_hash(self, value: TypeHash | dict[str, Any]) -> None:
        """Set it, also by the arguments of its class. Raises AssertionError for anything else."""
        assert isinstance(value, TypeHash | dict)
        self._topic_type_hash = TypeHash(**value) if isinstance(value, dict) else value

    @property
    def endpoint_type(self) -> TopicEndpointTypeEnum:
        """The kind of endpoint."""
        return self._endpoint_type

    @endpoint_type.setter
    def endpoint_type(self, value: TopicEndpointTypeEnum | int) -> None:
        """Set it, also by number. Raises AssertionError for no integer, ValueError for an unknown one."""
        assert isinstance(value, int)
        self._endpoint_type = TopicEndpointTypeEnum(value)

    @property
    def endpoint_gid(self) -> list[int]:
        """The gid."""
        return self._endpoint_gid

    @endpoint_gid.setter
    def endpoint_gid(self, value: list[int]) -> None:
        """Set it. Raises AssertionError if one of them is no integer."""
        assert all(isinstance(number, int) for number in value)
        self._endpoint_gid = value

    @property
    def qos_profile(self) -> QoSProfile:
        """The QoS profile; can be set from the keyword arguments of a QoSProfile."""
        return self._qos_profile

    @qos_profile.setter
    def qos_profile(self, value: QoSProfile | dict[str, Any]) -> None:
        """Set it, also by the arguments of its class. Raises AssertionError for anything else."""
        assert isinstance(value, QoSProfile | dict)
        self._qos_profile = QoSProfile(**value) if isinstance(value, dict) else value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TopicEndpointInfo) and all(
            getattr(self, slot) == getattr(other, slot) for slot in self.__slots__
        )

    __hash__ = None  # type: ignore[assignment]  # it can be changed

    def __str__(self) -> str:
        qos = self.qos_profile
        depth = f" ({qos.depth})" if qos.history == _HistoryPolicy.KEEP_LAST else ""
        return "\n".join(
            (
                f"Node name: {self.node_name}",
                f"Node namespace: {self.node_namespace}",
                f"Topic type: {self.topic_type}",
                f"Topic type hash: {self.topic_type_hash}",
                f"Endpoint type: {self.endpoint_type.name}",
                f"GID: {'.'.join(f'{number:02x}' for number in self.endpoint_gid)}",
                "QoS profile:",
                f"  Reliability: {qos.reliability.name}",
                f"  History (Depth): {qos.history.name}{depth}",
                f"  Durability: {qos.durability.name}",
                f"  Lifespan: {qos.lifespan}",
                f"  Deadline: {qos.deadline}",
                f"  Liveliness: {qos.liveliness.name}",
                f"  Liveliness lease duration: {qos.liveliness_lease_duration}",
            )
        )
