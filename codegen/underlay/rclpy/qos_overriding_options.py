"""QoS profiles that parameters change: `qos_overrides.<topic>.<publisher|subscription>[_<id>].<policy>`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult

from rclpy.duration import Duration
from rclpy.exceptions import ParameterAlreadyDeclaredException
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSLivelinessPolicy,
    QoSPolicyKind,
    QoSProfile,
    QoSReliabilityPolicy,
)
from rclpy.qos import QoSPolicyEnum as _QoSPolicyEnum
from rclpy.subscription import Subscription

if TYPE_CHECKING:
    from rclpy.node import Node

QosCallbackResult = SetParametersResult
QosCallbackType = Callable[[QoSProfile], QosCallbackResult]
QoSProfileAttributes = (
    QoSHistoryPolicy
    | int
    | QoSReliabilityPolicy
    | QoSDurabilityPolicy
    | Duration
    | QoSLivelinessPolicy
    | bool
)

_ENUMS: dict[QoSPolicyKind, type[_QoSPolicyEnum]] = {
    QoSPolicyKind.HISTORY: QoSHistoryPolicy,
    QoSPolicyKind.RELIABILITY: QoSReliabilityPolicy,
    QoSPolicyKind.DURABILITY: QoSDurabilityPolicy,
    QoSPolicyKind.LIVELINESS: QoSLivelinessPolicy,
}


class InvalidQosOverridesError(Exception):
    """The callback refused a profile."""


class QoSOverridingOptions:
    """The policies of an endpoint that get a parameter, and a callback that may refuse the outcome."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: QosCallbackType | None = None,
        entity_id: str | None = None,
    ) -> None:
        self._policy_kinds = policy_kinds
        self._callback = callback
        self._entity_id = entity_id

    @property
    def policy_kinds(self) -> Iterable[QoSPolicyKind]:
        """The policies that get a parameter."""
        return self._policy_kinds

    @property
    def callback(self) -> QosCallbackType | None:
        """The callback that checks the profile with its overrides."""
        return self._callback

    @property
    def entity_id(self) -> str | None:
        """The text that distinguishes this endpoint from others of the same kind on the topic."""
        return self._entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: QosCallbackType | None = None, entity_id: str | None = None
    ) -> QoSOverridingOptions:
        """Let history, depth and reliability be changed."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(policy_kinds=kinds, callback=callback, entity_id=entity_id)


def _declare_qos_parameters(
    entity_type: type[Publisher[Any]] | type[Subscription[Any]],
    node: Node,
    topic_name: str,
    qos: QoSProfile,
    options: QoSOverridingOptions,
) -> None:
    """Declare the parameters of an endpoint on `topic_name` (resolved) and put their values into `qos`.

    A second endpoint finds the parameters declared and takes their values. Raises RuntimeError for what is no
    value of a policy, InvalidQosOverridesError when the callback refuses.
    """
    if not issubclass(entity_type, Publisher | Subscription):
        raise TypeError("Argument `entity_type` should be a subclass of Publisher or Subscription")
    kind = "publisher" if issubclass(entity_type, Publisher) else "subscription"
    suffix = "" if options.entity_id is None else f"_{options.entity_id}"
    whose = f" for {kind} `{topic_name}` with id `{options.entity_id}`"
    allowed = _get_allowed_policies(entity_type)
    for policy in options.policy_kinds:
        if policy not in allowed:
            continue
        policy_name = policy.name.lower()
        name = f"qos_overrides.{topic_name}.{kind}{suffix}.{policy_name}"
        descriptor = ParameterDescriptor(description=f"{policy_name}{whose}", read_only=True)
        try:
            parameter = node.declare_parameter(name, _get_qos_policy_parameter(qos, policy), descriptor)
        except ParameterAlreadyDeclaredException:
            parameter = node.get_parameter(name)
        _override_qos_policy_with_param(qos, policy, parameter)
    if options.callback is not None:
        result = options.callback(qos)
        if not result.successful:
            raise InvalidQosOverridesError(f"Provided QoS overrides{whose}, are not valid: {result.reason}")


def _get_allowed_policies(
    entity_type: type[Publisher[Any]] | type[Subscription[Any]],
) -> list[QoSPolicyKind]:
    """Return what can be overridden: a subscription's lifespan cannot."""
    return [
        kind
        for kind in QoSPolicyKind
        if kind is not QoSPolicyKind.LIFESPAN or not issubclass(entity_type, Subscription)
    ]


def _get_qos_policy_parameter(qos: QoSProfile, policy: QoSPolicyKind) -> str | int | bool:
    """Return a policy as the value of its parameter: short key, nanoseconds or the number itself."""
    value: QoSProfileAttributes = getattr(qos, policy.name.lower())
    if isinstance(value, _QoSPolicyEnum):
        if value.name == "UNKNOWN":
            raise ValueError("User provided QoS profile is invalid")
        return value.short_key
    return value.nanoseconds if isinstance(value, Duration) else value


def _override_qos_policy_with_param(qos: QoSProfile, policy: QoSPolicyKind, param: Parameter) -> None:
    """Put the value of a policy's parameter into the profile."""
    policy_name = policy.name.lower()
    value = param.value
    if policy in _ENUMS:
        try:
            value = _ENUMS[policy][value.upper()]
        except KeyError:
            raise RuntimeError(f"Unexpected QoS override for policy `{policy_name}`: `{value}`") from None
    elif policy in (
        QoSPolicyKind.LIFESPAN,
        QoSPolicyKind.DEADLINE,
        QoSPolicyKind.LIVELINESS_LEASE_DURATION,
    ):
        value = Duration(nanoseconds=value)
    setattr(qos, policy_name, value)
