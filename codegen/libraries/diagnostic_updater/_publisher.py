"""Tasks about topics, and a publisher that has one."""

from __future__ import annotations

from typing import Any

from rclpy.publisher import Publisher

from diagnostic_updater._diagnostic_updater import CompositeDiagnosticTask, Updater
from diagnostic_updater._update_functions import (
    FrequencyStatus,
    FrequencyStatusParam,
    TimeStampStatus,
    TimeStampStatusParam,
)


class HeaderlessTopicDiagnostic(CompositeDiagnosticTask):
    """Watches how often messages come on a topic: call `tick` for each. It adds itself to an updater."""

    def __init__(self, name: str, diag: Updater, freq: FrequencyStatusParam) -> None:
        super().__init__(f"{name} topic status")
        self.diag = diag
        self.freq = FrequencyStatus(freq)
        self.addTask(self.freq)
        diag.add(self)

    def tick(self) -> None:
        """Count a message."""
        self.freq.tick()

    def clear_window(self) -> None:
        """Forget the frequency so far."""
        self.freq.clear()


class TopicDiagnostic(HeaderlessTopicDiagnostic):
    """Watches, besides, how old the stamps of messages are, on the clock of the updater's node."""

    def __init__(
        self, name: str, diag: Updater, freq: FrequencyStatusParam, stamp: TimeStampStatusParam
    ) -> None:
        super().__init__(name, diag, freq)
        self.stamp = TimeStampStatus(stamp, clock=diag.node.get_clock())
        self.addTask(self.stamp)

    def tick(self, stamp: Any) -> None:  # type: ignore[override]  # upstream's signature
        """Count a message with this stamp: a number [s], a Time, or its message."""
        self.stamp.tick(stamp)
        super().tick()


class DiagnosedPublisher(TopicDiagnostic):
    """A publisher of messages with a header, with a task about them."""

    def __init__(
        self, pub: Publisher[Any], diag: Updater, freq: FrequencyStatusParam, stamp: TimeStampStatusParam
    ) -> None:
        super().__init__(pub.topic_name, diag, freq, stamp)
        self.publisher = pub

    def publish(self, message: Any) -> None:
        """Publish a message, and count it by `header.stamp`."""
        self.tick(message.header.stamp)
        self.publisher.publish(message)
