"""Classes that newer ROS has and Jazzy has not; programs find them where `rclpy.impl.distro` says."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, Any, TypedDict

from rclpy.clock import ClockType
from rclpy.qos import QoSProfile
from rclpy.time import Time
from rclpy.type_hash import TypeHash

if TYPE_CHECKING:
    from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


class TimerInfo:
    """The times of one call of a timer [ns on its clock]: expected, and actual.

    :raises ValueError: if one of them is negative.
    :raises TypeError: for what is no ClockType.
    """

    __module__ = "rclpy.timer"

    def __init__(
        self,
        *,
        expected_call_time: int = 0,
        actual_call_time: int = 0,
        clock_type: ClockType | _rclpy.ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        if expected_call_time < 0 or actual_call_time < 0:
            raise ValueError("call time values must not be negative")
        self._expected_call_time = Time(nanoseconds=expected_call_time, clock_type=ClockType(clock_type))
        self._actual_call_time = Time(nanoseconds=actual_call_time, clock_type=ClockType(clock_type))

    @property
    def expected_call_time(self) -> Time:
        """The time at which the call was due."""
        return self._expected_call_time

    @property
    def actual_call_time(self) -> Time:
        """The time at which the call was made."""
        return self._actual_call_time


class MessageInfo(TypedDict):
    """The second argument of a subscription's callback; times in ns, system time."""

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int | None
    reception_sequence_number: int | None
    publisher_gid: dict[str, str | bytes] | None


MessageInfo.__module__ = "rclpy.subscription"


class EndpointTypeEnum(IntEnum):
    """The kind of an endpoint."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2
    CLIENT = 3
    SERVER = 4


EndpointTypeEnum.__module__ = "rclpy.endpoint_info"


@dataclass(eq=True)
class ServiceEndpointInfo:
    """One client or server of a service: its node, its type, and gids and QoS profiles of its ends.

    The hash and the profiles can be set from the keyword arguments of their classes. Raises AssertionError
    for values of a wrong type.
    """

    node_name: str = ""
    node_namespace: str = ""
    service_type: str = ""
    service_type_hash: Any = field(default_factory=TypeHash)
    qos_profiles: list[Any] = field(default_factory=list)
    endpoint_gids: list[list[int]] = field(default_factory=list)
    endpoint_type: EndpointTypeEnum = EndpointTypeEnum.INVALID
    endpoint_count: int = 0

    def __setattr__(self, name: str, value: Any) -> None:
        kinds: dict[str, type] = {
            "service_type_hash": TypeHash,
            "qos_profiles": list,
            "endpoint_gids": list,
            "endpoint_type": int,
            "endpoint_count": int,
        }
        made = value
        if name == "service_type_hash" and isinstance(value, dict):
            made = TypeHash(**value)
        elif name == "qos_profiles" and isinstance(value, list):
            made = [QoSProfile(**each) if isinstance(each, dict) else each for each in value]
        elif name == "endpoint_type" and isinstance(value, int):
            made = EndpointTypeEnum(value)
        assert isinstance(made, kinds.get(name, str))
        super().__setattr__(name, made)

    def __str__(self) -> str:
        lines = [
            f"Node name: {self.node_name}",
            f"Node namespace: {self.node_namespace}",
            f"Service type: {self.service_type}",
            f"Service type hash: {self.service_type_hash}",
            f"Endpoint type: {self.endpoint_type.name}",
            f"Endpoint count: {self.endpoint_count}",
        ]
        for gid, qos in zip(self.endpoint_gids, self.qos_profiles, strict=False):
            lines += [f"GID: {'.'.join(f'{number:02x}' for number in gid)}", f"QoS profile: {qos}"]
        return "\n".join(lines)


# Where programs know it from; dataclass needs the other one while it makes the class.
ServiceEndpointInfo.__module__ = "rclpy.endpoint_info"
