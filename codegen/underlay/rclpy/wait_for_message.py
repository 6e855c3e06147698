"""Waiting for one message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerGuardCondition
from rclpy.utilities import timeout_sec_to_nsec

if TYPE_CHECKING:
    from rclpy.impl.typed import MessageT
else:
    __getattr__ = reexport(__name__)


def wait_for_message(
    msg_type: type[MessageT],
    node: Node,
    topic: str,
    *,
    qos_profile: QoSProfile | int = 1,
    time_to_wait: float = -1,
) -> tuple[Literal[True], MessageT] | tuple[Literal[False], None]:
    """Wait for the next message on a topic, at most `time_to_wait` seconds (-1: no limit), with no executor.

    Returns (True, message), or (False, None) at the timeout or on Ctrl-C.
    """
    context = node.context
    wait_set = _rclpy.WaitSet(1, 1, 0, 0, 0, 0, context.handle)
    interrupted = SignalHandlerGuardCondition(context=context)
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile=qos_profile)
    try:
        index = wait_set.add_subscription(subscription.handle)
        interruption = wait_set.add_guard_condition(interrupted.handle)
        wait_set.wait(timeout_sec_to_nsec(time_to_wait))
        if wait_set.is_ready("guard_condition", interruption) or not wait_set.is_ready("subscription", index):
            return False, None
        taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        return (False, None) if taken is None else (True, taken[0])
    finally:
        interrupted.destroy()
        node.destroy_subscription(subscription)
