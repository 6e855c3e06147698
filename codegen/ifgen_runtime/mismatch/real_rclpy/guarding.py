"""Puts a guard before an endpoint whose node refuses or adapts: a handle that looks at each message.

Executors, `spin_until_future_complete` and `wait_for_message` take from the handle, so all of them get only
what the guard lets through. The experimental EventsExecutor of rclpy takes in C++, and passes by.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ifgen_runtime.mismatch.real_rclpy.guarded_client import guarded_client
from ifgen_runtime.mismatch.real_rclpy.guarded_service import guarded_service
from ifgen_runtime.mismatch.real_rclpy.guarded_subscription import guarded_subscription

if TYPE_CHECKING:
    from ifgen_runtime.mismatch.policy import OnTypeMismatch
    from ifgen_runtime.mismatch.real_rclpy.endpoints import Guard


def guarded(
    node: Any,
    role: str,
    cls: type[Any],
    policy: OnTypeMismatch,
    arguments: tuple[Any, ...],
    named: dict[str, Any],
) -> tuple[tuple[Any, ...], Guard]:
    """The arguments of a constructor of rclpy with a guarded handle in them, and the guard."""
    match role:
        case "subscription":
            plain, message_type, topic, callback, group, qos, *rest = arguments
            subscription = guarded_subscription(node, topic, qos, cls, policy)
            called = getattr(named.get("event_callbacks"), "incompatible_type", None)
            subscription.guard.call_on_foreign(called, group)
            guard: Guard = subscription.guard
            arguments = (subscription, message_type, topic, callback, group, qos, *rest)
        case "service server":
            plain, service_type, name, callback, group, qos = arguments
            service = guarded_service(node, name, qos, cls, policy)
            guard = service.guard
            arguments = (service, service_type, name, callback, group, qos)
        case _:
            context, plain, service_type, name, qos, group = arguments
            client = guarded_client(node, name, qos, cls, policy)
            guard = client.guard
            arguments = (context, client, service_type, name, qos, group)
    plain.destroy_when_not_in_use()
    return arguments, guard
