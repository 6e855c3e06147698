"""Subscribes to topics when they appear, and hands on what comes, as bytes."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError

from ifgen_tools.bag.qos import adapted_request
from ifgen_tools.bag.saying import say, warn
from ifgen_tools.bag.selection import Selection
from ifgen_tools.errors import ToolError
from ifgen_tools.types import WireType, class_with_hash

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription

_DEPTH: Final = 100_000
"""Messages of a topic that the middleware may hold while a turn of another one is written."""

_AROUND: Final = 200
"""Bytes that a waiting message takes besides its own."""

_AT_ONCE: Final = 5000
"""Messages of a topic that are taken or written before others get their turn."""

_BYTES_AT_ONCE: Final = 2**20
"""Bytes of a topic after which others get their turn: small messages must not wait for 200 images."""

_COUNTING: Final = 2.0
"""Seconds at most for counting what is not recorded any more."""

_AGAIN: Final = 50
"""Looks at the graph after which somebody who did not describe a type is asked again."""

Write: TypeAlias = Callable[[bytes, int, int], None]
"""Takes a message: its bytes, when it was received and when it was published [ns]."""

Open: TypeAlias = "Callable[[str, type[Any], list[QoSProfile]], Write]"
"""Begins a topic, of messages of a class, with the QoS that its publishers offer."""


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """The topics to record, and how to record them."""

    choice: Selection
    overrides: dict[str, QoSProfile] = field(default_factory=dict)
    include_unpublished: bool = False
    ignore_leaves: bool = False
    use_sim_time: bool = False
    most_waiting: int = 2**30
    """Bytes of messages that may wait for the disk. What comes then is left out, and counted."""


@dataclass(slots=True)
class _Source:
    """A subscription, where its messages go, and those that wait for the disk."""

    topic: str
    subscription: Subscription[Any]
    write: Write
    waiting: deque[tuple[bytes, int, int]] = field(default_factory=deque[tuple[bytes, int, int]])

    def take(self, until: int | None = None) -> Any:
        """The next message of the middleware and its metadata; None if none came until then [ns]."""
        with self.subscription.handle:
            taken = self.subscription.handle.take_message(self.subscription.msg_type, True)
        if taken is None or (until is not None and _received(taken[1]) > until):
            return None
        return taken


class TopicRecorder:
    """Records what is chosen, each definition of a topic's type for itself."""

    def __init__(self, node: Node, options: RecordOptions, open: Open) -> None:
        """Subscribe with a node."""
        self.is_paused = False
        self.left: Counter[str] = Counter()
        """Messages that were received and are not recorded, by topic."""
        self._waiting_size = 0
        self._node, self._options, self._open = node, options, open
        self._subscribed: dict[tuple[str, WireType], _Source] = {}
        self._asked: dict[tuple[str, WireType], Future[type[Any]]] = {}
        self._refused: dict[tuple[str, WireType], int] = {}
        self._lost: dict[str, int] = {}
        self._warned: set[str] = set()
        self._asking = ThreadPoolExecutor(1, "describe")
        # Messages of another definition would not be what the bag says that they are.
        node.on_type_mismatch = "refuse"  # type: ignore[attr-defined]  # pyright: ignore

    @property
    def topics(self) -> list[str]:
        """The topics that are recorded."""
        return sorted({topic for topic, _ in self._subscribed})

    @property
    def lost(self) -> dict[str, int]:
        """How many messages of which topic were lost on the way here."""
        return dict(self._lost)

    def look(self) -> None:
        """Subscribe to what has appeared since the last look."""
        for topic, _ in self._node.get_topic_names_and_types():
            for wire in self._wanted(topic):
                key = topic, wire
                if key not in self._subscribed and self._may_ask(key):
                    self._take(key)

    @property
    def has_waiting(self) -> bool:
        """Whether messages wait for the disk."""
        return self._waiting_size > 0

    def record_some(self) -> None:
        """Record what waits, a turn of each topic."""
        for source in tuple(self._subscribed.values()):
            if self._turn(source):  # the disk may be slow: the middleware must not overflow meanwhile
                for other in self._subscribed.values():
                    self._gather(other, other.take())

    def drain(self, until: int, may_go_on: Callable[[], bool]) -> None:
        """Record what waits and was received until a time [ns since 1970], each topic in its turn."""
        waiting = list(self._subscribed.values())
        while waiting:
            for source in tuple(waiting):
                if not may_go_on():
                    return
                taken = source.take(until)
                if taken is None and not source.waiting:
                    waiting.remove(source)
                    continue
                self._gather(source, taken, until)
                self._turn(source)

    def leave(self, until: int) -> None:
        """Take what waits and was received until a time [ns since 1970], and only count it."""
        end = time.monotonic() + _COUNTING
        for source in self._subscribed.values():
            self.left[source.topic] += len(source.waiting)
            while time.monotonic() < end and source.take(until) is not None:
                self.left[source.topic] += 1

    def _gather(self, source: _Source, taken: Any, until: int | None = None) -> None:
        """Keep a message and those that the middleware has after it, until it is the turn of others."""
        count = 0
        while taken is not None:
            self._keep(source, *taken)
            count += 1
            taken = source.take(until) if count < _AT_ONCE else None

    def _keep(self, source: _Source, data: bytes, info: Any) -> None:
        """Let a message wait for the disk, or count it if too much waits."""
        if self.is_paused:
            return
        use_sim_time = self._options.use_sim_time
        received = self._node.get_clock().now().nanoseconds if use_sim_time else _received(info)
        if not received:  # there is no simulated time before the first /clock
            return
        size = self._waiting_size + len(data) + _AROUND
        if self._waiting_size and size > self._options.most_waiting:
            self.left[source.topic] += 1
            return
        source.waiting.append((data, received, info["source_timestamp"] or received))
        self._waiting_size = size

    def _turn(self, source: _Source) -> bool:
        """Record what waits of a topic; returns whether that took a whole turn."""
        waiting, count, size = source.waiting, 0, 0
        while waiting and count < _AT_ONCE and size < _BYTES_AT_ONCE:
            message = waiting.popleft()
            length = len(message[0])
            self._waiting_size -= length + _AROUND
            source.write(*message)
            count, size = count + 1, size + length
        return count >= _AT_ONCE or size >= _BYTES_AT_ONCE

    def close(self) -> None:
        """Stop to record."""
        self._asking.shutdown(wait=False, cancel_futures=True)
        for source in self._subscribed.values():
            self._node.destroy_subscription(source.subscription)

    def _wanted(self, topic: str) -> list[WireType]:
        """The types of a topic to record, as its publishers have them."""
        node, options = self._node, self._options
        infos = node.get_publishers_info_by_topic(topic)
        own = node.get_name()
        others = [info for info in node.get_subscriptions_info_by_topic(topic) if info.node_name != own]
        if options.ignore_leaves and not others:
            return []
        if not infos and options.include_unpublished:
            infos = others
        types = {
            WireType(
                info.topic_type, text if (text := str(info.topic_type_hash)).startswith("RIHS01_") else None
            )
            for info in infos
            if options.choice.takes(topic, info.topic_type)
        }
        return sorted(types, key=lambda wire: (wire.name, wire.hash or ""))

    def _may_ask(self, key: tuple[str, WireType]) -> bool:
        left = self._refused.get(key, 0)
        self._refused[key] = max(left - 1, 0)
        return left == 0

    def _take(self, key: tuple[str, WireType]) -> None:
        topic, wire = key
        if others := [of.name for name, of in self._subscribed if name == topic and of.name != wire.name]:
            # A participant of DDS can have one type for each topic.
            self._warn(
                f"{topic} is recorded with messages of {others[0]}: those of {wire.name} are not recorded"
            )
            return
        cls = _installed(wire)
        if cls is None:
            asked = self._asked.get(key)
            if asked is None:
                self._asked[key] = self._asking.submit(class_with_hash, self._node, topic, wire)
            if asked is None or not asked.done():
                return
            del self._asked[key]
            try:
                cls = asked.result()
            except ToolError as error:
                self._refused[key] = _AGAIN
                self._warn(f"{topic} is not recorded: {error.message}")
                return
        self._subscribe(key, cls)

    def _subscribe(self, key: tuple[str, WireType], cls: type[Any]) -> None:
        topic, wire = key
        offers = [
            info.qos_profile
            for info in self._node.get_publishers_info_by_topic(topic)
            if info.topic_type == wire.name
        ]

        def hear(data: bytes, info: Any) -> None:
            """Take what waits besides, without a turn of the executor for each: half the time."""
            self._gather(source, (data, info))

        try:
            subscription = self._subscription(topic, cls, hear, self._profile(topic, offers))
        except (RuntimeError, ValueError) as error:  # RCLError has no public name
            self._refused[key] = _AGAIN
            self._warn(f"{topic} is not recorded: {error}")
            return
        source = self._subscribed[key] = _Source(topic, subscription, self._open(topic, cls, offers))
        say(f"Subscribed to topic '{topic}'")

    def _subscription(
        self, topic: str, cls: type[Any], record: Callable[[bytes, Any], None], profile: QoSProfile
    ) -> Subscription[Any]:
        def count(status: Any) -> None:
            self._lost[topic] = self._lost.get(topic, 0) + status.total_count_change

        events = SubscriptionEventCallbacks(message_lost=count)
        try:
            return self._node.create_subscription(
                cls, topic, record, profile, raw=True, event_callbacks=events
            )
        except UnsupportedEventTypeError:  # this middleware does not say what is lost
            return self._node.create_subscription(cls, topic, record, profile, raw=True)

    def _profile(self, topic: str, offers: list[QoSProfile]) -> QoSProfile:
        if (override := self._options.overrides.get(topic)) is not None:
            return override
        profile, mixed = adapted_request(offers, _DEPTH)
        for policy in mixed:
            self._warn(
                f"some, but not all, publishers on {topic} offer more {policy}: the least of them is asked "
                "for, so that all match" + _CONSEQUENCE[policy]
            )
        return profile

    def _warn(self, text: str) -> None:
        if text not in self._warned:
            self._warned.add(text)
            warn(text)


_CONSEQUENCE: Final = {
    "reliability": ", and messages may be lost",
    "durability": ", and what was published before is not recorded",
}


def _received(info: Any) -> int:
    """When a message was received [ns since 1970]; now, if the middleware does not say."""
    return info["received_timestamp"] or time.time_ns()


def _installed(wire: WireType) -> type[Any] | None:
    """The class that is installed or generated, if it has this definition."""
    package, folder, name = (*wire.name.split("/", 2), "", "")[:3]
    try:
        cls = getattr(import_module(f"{package}.{folder}"), name, None)
    except Exception:  # of a package that somebody else wrote: the publisher can describe its type
        return None
    fits = cls is not None and wire.hash in {None, getattr(cls, "__type_hash__", wire.hash)}
    return cls if fits else None
