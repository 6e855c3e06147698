"""A memory of the messages that came last."""

from typing import Any

from rclpy.time import Time

from message_filters import _stamps
from message_filters.simple_filter import SimpleFilter


class Cache(SimpleFilter):
    """Keeps the last `cache_size` messages in the order in which they came, and passes each on.

    Their times are those of their headers. A message without one has the time at which it came if
    `allow_headerless` is set; otherwise it is dropped with a warning.
    """

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__()
        self.cache_size = cache_size
        self.cache_msgs: list[Any] = []
        self.cache_times: list[Time] = []
        self.allow_headerless = allow_headerless
        self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:
        """Take the output of a filter in."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Take a message in."""
        stamp = _stamps.stamp_of(
            msg, self.allow_headerless, "message_filters_cache", "can not use message filters messages"
        )
        if stamp is None:
            return
        self.cache_times.append(stamp)
        self.cache_msgs.append(msg)
        if len(self.cache_msgs) > self.cache_size:
            del self.cache_msgs[0]
            del self.cache_times[0]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:
        """Return the messages from one time to another, both included."""
        assert from_stamp <= to_stamp
        return [msg for msg, time in self._contents() if from_stamp <= time <= to_stamp]

    def getElemAfterTime(self, stamp: Time) -> Any | None:
        """Return the first message that came in with this time or a later one, or None."""
        return next((msg for msg, time in self._contents() if time >= stamp), None)

    def getElemBeforeTime(self, stamp: Time) -> Any | None:
        """Return the last message that came in with this time or an earlier one, or None."""
        return next((msg for msg, time in reversed(self._contents()) if time <= stamp), None)

    def getLastestTime(self) -> Time | None:
        """Return the time of the message that came last, or None; the spelling is upstream's."""
        return self.cache_times[-1] if self.cache_times else None

    def getOldestTime(self) -> Time | None:
        """Return the time of the message that came first, or None."""
        return self.cache_times[0] if self.cache_times else None

    def getLast(self) -> Any | None:
        """Return the first message with the time of the last one or a later time, or None."""
        latest = self.getLastestTime()
        return None if latest is None else self.getElemAfterTime(latest)

    def _contents(self) -> list[tuple[Any, Time]]:
        return list(zip(self.cache_msgs, self.cache_times, strict=False))
