"""Handles of topics that look at each message: whose definition it has, and whether its values are in range.

Since Kilted rclpy tells each message's publisher. On Jazzy it does not. There, all who may have sent a
message must have one definition.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from rclpy import subscription as subscriptions

from ifgen_runtime.adapters import short
from ifgen_runtime.checks.ranges import look_at
from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.reporting import SeenSet
from ifgen_runtime.real_rclpy.carriers import Publisher, Subscription, decoded
from ifgen_runtime.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.real_rclpy.peers import Others, Peer, applied, differs

_GID: Final = "publisher_gid"

TELLS_PUBLISHER: Final = _GID in getattr(getattr(subscriptions, "MessageInfo", None), "__annotations__", ())
"""Whether this rclpy tells with a message who has published it."""


@dataclass(slots=True)
class IncompatibleType:
    """The argument of a subscription's callback `incompatible_type`: rclpy's own type cannot be filled in."""

    total_count: int
    """How many publishers with another definition have been there."""
    total_count_change: int
    """How many of them have come since the callback was last called."""


class SubscriptionGuard:
    """Decides about each message of a topic."""

    must_agree = not TELLS_PUBLISHER

    def __init__(self, node: Any, part: Part, policy: OnTypeMismatch) -> None:
        self._node = weakref.ref(node)
        self._part = part
        self._policy = policy
        self._others = Others(node, part)
        self._refused, self._said = SeenSet(), SeenSet()
        self._event: Any = None
        self._counts = IncompatibleType(0, 0)

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all publishers that are there now."""
        found = [peer for _, peer in others]
        self._others.see(found)
        for peer in found:
            if differs(peer, self._part) and self._is_refused(peer.type_hash) and self._refused.add(peer.gid):
                self._counts.total_count += 1
                self._counts.total_count_change += 1
                if self._event is not None:
                    self._event.trigger()

    def message(self, data: bytes, info: Mapping[str, Any], raw: bool) -> Any:
        """The message to deliver, or its bytes for `raw`; None if it is not to be delivered."""
        type_hash = self._hash_of(info)
        if type_hash is None or self._is_refused(type_hash):
            return None
        if raw:
            return data if type_hash == self._part.type_hash else None
        try:
            message = decoded(data, type_hash, self._part.cls)
        except Exception as error:  # the user's adapter: what a peer sends must not end the node's spin
            self._say(f"The adapter from {short(type_hash)} failed, and the message was dropped: {error!r}")
            return None
        if message is None:
            self._say(f"A message did not fit its definition, {short(type_hash)}, and was dropped")
        return message

    def call_on_refused(self, callback: Callable[[IncompatibleType], object] | None, group: Any) -> None:
        """Call back in this callback group when a publisher comes that is refused."""
        node = self._node()
        if callback is None or node is None:
            return

        def call() -> object:
            now = IncompatibleType(self._counts.total_count, self._counts.total_count_change)
            self._counts.total_count_change = 0
            return callback(now)

        self._event = node.create_guard_condition(call, group)

    def end(self) -> None:
        """Call back no more."""
        node, event = self._node(), self._event
        self._event = None
        if node is not None and event is not None:
            node.destroy_guard_condition(event)

    def _hash_of(self, info: Mapping[str, Any]) -> str | None:
        """The definition of a message; None if nobody can tell, or if somebody is refused."""
        gid = info.get(_GID)
        if gid is None:
            senders = self._others.senders_at(info["received_timestamp"])
            return next(iter(senders)) if len(senders) == 1 else None
        type_hash = self._others.hash_of(gid["data"])
        return None if any(map(self._is_refused, self._others.hashes)) else type_hash

    def _is_refused(self, type_hash: str) -> bool:
        if type_hash == self._part.type_hash:
            return False
        return applied(self._policy, "subscription", [(self._part, type_hash)]) is OnTypeMismatch.REFUSE

    def _say(self, text: str) -> None:
        node = self._node()
        if node is not None and self._said.add(text):
            node.get_logger().error(
                f"topic '{self._part.topic.removeprefix('rt')}': {text}. This is said once."
            )


class GuardedSubscription(Subscription):
    """rclpy's handle, with a guard."""

    guard: SubscriptionGuard
    look: Callable[[Any], None] | None = None
    """Looks at the ranges of a message."""

    def take_message(self, message_type: type[Any], raw: bool) -> tuple[Any, Mapping[str, Any]] | None:
        """The next message and what is known of it, as rclpy takes it; None if there is none to deliver."""
        taken = super().take_message(message_type, True)
        if taken is None:
            return None
        data, info = taken
        message = self.guard.message(data, info, raw)
        if message is None:
            return None
        if self.look is not None and not raw:
            self.look(message)
        return message, info


class LookingSubscription(Subscription):
    """rclpy's handle, with a look at the ranges of each message."""

    look: Callable[[Any], None]

    def take_message(self, message_type: type[Any], raw: bool) -> tuple[Any, Mapping[str, Any]] | None:
        """The next message and what is known of it, as rclpy takes it."""
        taken = super().take_message(message_type, raw)
        if taken is not None and not raw:
            self.look(taken[0])
        return taken


class LookingPublisher(Publisher):
    """rclpy's handle, with a look at the ranges of each message."""

    look: Callable[[Any], None]

    def publish(self, message: Any) -> None:
        """Look at a message, and publish it."""
        self.look(message)
        super().publish(message)


def looking(plain: Any, node: Any, cls: type[Any], topic: str, qos: Any) -> Any:
    """A handle that looks at the ranges of messages, in the place of a plain one; that one without ranges."""
    verb = "published" if isinstance(plain, Publisher) else "received"
    look = look_at(cls, plain.get_topic_name(), verb, node.get_logger().warning)
    if look is None or isinstance(plain, GuardedSubscription):
        if isinstance(plain, GuardedSubscription):
            plain.look = look
        return plain
    kind = LookingPublisher if isinstance(plain, Publisher) else LookingSubscription
    with node.handle:
        handle = kind(node.handle, cls, topic, qos.get_c_qos_profile())
    handle.look = look
    plain.destroy_when_not_in_use()
    return handle


def guarded_subscription(
    node: Any, topic: str, qos: Any, cls: type[Any], policy: OnTypeMismatch
) -> GuardedSubscription:
    """A handle for a subscription of a node. `topic` is as its caller wrote it."""
    with node.handle:
        handle = GuardedSubscription(node.handle, cls, topic, qos.get_c_qos_profile())
    (part,) = parts_of("subscription", handle.get_topic_name(), cls, qos)
    handle.guard = SubscriptionGuard(node, part, policy)
    return handle
