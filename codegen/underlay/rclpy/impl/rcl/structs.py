"""The enumerations and structs of upstream's extension module, all read-only."""

from __future__ import annotations

from enum import Enum, IntEnum
from typing import NamedTuple, NoReturn


class ExtensionEnum(IntEnum):
    """An unscoped C enumeration: equal to the integers; prints as `ClassName.MEMBER`."""

    def __str__(self) -> str:
        return f"{type(self).__name__}.{self.name}"


class ScopedEnum(Enum):
    """A scoped C++ enumeration: converts to an integer, but equals none."""

    value: int

    def __int__(self) -> int:
        return self.value

    __index__ = __int__


class rmw_qos_policy_kind_t(ExtensionEnum):
    """The QoS policy that an event is about."""

    RMW_QOS_POLICY_INVALID = 1
    RMW_QOS_POLICY_DURABILITY = 2
    RMW_QOS_POLICY_DEADLINE = 4
    RMW_QOS_POLICY_LIVELINESS = 8
    RMW_QOS_POLICY_RELIABILITY = 16
    RMW_QOS_POLICY_HISTORY = 32
    RMW_QOS_POLICY_LIFESPAN = 64
    RMW_QOS_POLICY_DEPTH = 128
    RMW_QOS_POLICY_LIVELINESS_LEASE_DURATION = 256
    RMW_QOS_POLICY_AVOID_ROS_NAMESPACE_CONVENTIONS = 512


class rcl_publisher_event_type_t(ExtensionEnum):
    """The events of a publisher."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class rcl_subscription_event_type_t(ExtensionEnum):
    """The events of a subscription."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class rmw_request_id_t(NamedTuple):
    """A request of a client."""

    sequence_number: int
    writer_guid: bytes


class rmw_service_info_t(NamedTuple):
    """The header of a request or a response; stamps in ns of system time."""

    source_timestamp: int
    received_timestamp: int
    request_id: rmw_request_id_t


class _Status:
    """Numbers, 0 where none is given, that do not change. No dataclass: eight of them take 5 ms to make."""

    def __init__(self, *numbers: int) -> None:
        names = type(self).__annotations__
        self.__dict__.update(dict.fromkeys(names, 0))
        self.__dict__.update(zip(names, numbers, strict=False))

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"can't set attribute '{name}'")

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name}={number!r}" for name, number in vars(self).items())
        return f"{type(self).__name__}({numbers})"


class rmw_requested_deadline_missed_status_t(_Status):
    """Periods in which a subscription got no message."""

    total_count: int
    total_count_change: int


class rmw_offered_deadline_missed_status_t(_Status):
    """Periods in which a publisher sent no message."""

    total_count: int
    total_count_change: int


class rmw_liveliness_lost_status_t(_Status):
    """The number of times that a publisher did not say in time that it is alive."""

    total_count: int
    total_count_change: int


class rmw_message_lost_status_t(_Status):
    """Messages that a subscription should have got."""

    total_count: int
    total_count_change: int


class rmw_liveliness_changed_status_t(_Status):
    """The number of publishers of a subscription that are alive, and of those that stopped."""

    alive_count: int
    not_alive_count: int
    alive_count_change: int
    not_alive_count_change: int


class rmw_matched_status_t(_Status):
    """Counterparts that came and went."""

    total_count: int
    total_count_change: int
    current_count: int
    current_count_change: int


class rmw_incompatible_type_status_t(_Status):
    """Counterparts with another type."""

    total_count_change: int


class rmw_requested_qos_incompatible_event_status_t(_Status):
    """Counterparts whose QoS does not match."""

    total_count: int
    total_count_change: int
    last_policy_kind: rmw_qos_policy_kind_t

    def __init__(
        self,
        total_count: int = 0,
        total_count_change: int = 0,
        last_policy_kind: rmw_qos_policy_kind_t = rmw_qos_policy_kind_t.RMW_QOS_POLICY_INVALID,
    ) -> None:
        super().__init__(total_count, total_count_change, last_policy_kind)
