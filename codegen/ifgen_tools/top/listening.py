"""Subscriptions to the topics that somebody looks at: for their rates and sizes, and their latest messages.

They are raw, so nothing is decoded that is not looked at, and best effort, so no publisher waits for them.
A topic whose publishers all keep what they sent is subscribed to reliably: otherwise DDS would not send that.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.types import topic_class

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.top.collector import Topic

_DEPTH: Final = 10
_PATIENCE: Final = 0.5  # [s] for a node that is to describe a type
_MOST: Final = 60
"""The number of topics that are listened to at a time."""

OnMessage = Callable[[str, bytes, type[Any]], None]
"""Called with the topic, the bytes and the class of a message."""


class Tap:
    """One subscription, and what has come by it."""

    def __init__(self, topic: str, cls: type[Any], on_message: OnMessage) -> None:
        self.topic = topic
        self.cls = cls
        self.latest: bytes | None = None
        self.mean_size: float | None = None
        self.rate: float | None = None
        self.subscription: Any = None
        self._on_message = on_message
        self._count = self._size = 0
        self._since = time.monotonic()

    def accept(self, data: bytes) -> None:
        """Note a message."""
        self._count += 1
        self._size += len(data)
        self.latest = data
        self._on_message(self.topic, data, self.cls)

    def turn(self) -> None:
        """Begin a new period; the figures are then those of the one that has ended."""
        now = time.monotonic()
        if now > self._since:
            self.rate = self._count / (now - self._since)
        if self._count:
            self.mean_size = self._size / self._count
        self._count = self._size = 0
        self._since = now


class Listener:
    """Listens to what is wanted, and to nothing else."""

    def __init__(self, node: Node, on_message: OnMessage) -> None:
        self.taps: dict[str, Tap] = {}
        self.notes: dict[str, str] = {}
        """Why a topic is not listened to, by topic."""
        self._node = node
        self._on_message = on_message

    def update(self, wanted: list[str], topics: dict[str, Topic]) -> None:
        """Subscribe to topics that are new among those wanted, and let go of the others."""
        known = [name for name in dict.fromkeys(wanted) if name in topics][:_MOST]
        for name in [each for each in self.taps if each not in known]:
            self._node.destroy_subscription(self.taps.pop(name).subscription)
        self.notes = {name: why for name, why in self.notes.items() if name in topics}
        for name in known:
            if name not in self.taps and name not in self.notes and topics[name].publishers:
                try:
                    self._open(name, topics[name])
                except ToolError as error:
                    self.notes[name] = error.message

    def turn(self) -> None:
        """Begin a new period of all of them."""
        for tap in self.taps.values():
            tap.turn()

    def close(self) -> None:
        """Let go of all of them."""
        self.update([], {})

    def _open(self, name: str, topic: Topic) -> None:
        from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # of the chosen transport

        tap = Tap(name, topic_class(self._node, name, _PATIENCE), self._on_message)
        reliability = ReliabilityPolicy.RELIABLE if topic.is_kept else ReliabilityPolicy.BEST_EFFORT
        durability = DurabilityPolicy.TRANSIENT_LOCAL if topic.is_kept else DurabilityPolicy.VOLATILE
        profile = QoSProfile(depth=_DEPTH, reliability=reliability, durability=durability)
        tap.subscription = self._node.create_subscription(
            tap.cls, name, partial(Tap.accept, tap), profile, raw=True
        )
        self.taps[name] = tap
