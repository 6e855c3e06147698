"""Filters of one input: their base, the source of a chain, a memory, and filters one after the other."""

from collections.abc import Callable
from dataclasses import dataclass
from types import CoroutineType
from typing import Any

from rclpy.clock import ROSClock
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.time import Time


class SimpleFilter:
    """Calls back with each message that a filter passes on. Derived classes say which those are.

    The executor of the node whose messages these are runs callbacks that are coroutine functions, as tasks.
    """

    node: Any = None  # of filters that have one
    _source: "SimpleFilter | None" = None  # the filter whose output comes in; the last one of several

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Call a function with each output, and `args` after it. Returns a number to unregister it by."""
        receiver = getattr(cb, "__self__", None)
        if isinstance(receiver, SimpleFilter):
            receiver._source = self
        # Upstream counts those that are there, so that one may take the place of another after a removal.
        connection = max(self.callbacks, default=-1) + 1
        self.callbacks[connection] = (cb, args)
        return connection

    def signalMessage(self, *msg: Any) -> None:
        """Call all callbacks, in the order in which they were registered."""
        for callback, args in tuple(self.callbacks.values()):
            result = callback(*msg, *args)
            if isinstance(result, CoroutineType):
                self._run(callback, result)

    def _run(self, callback: Callable[..., Any], coroutine: Any) -> None:
        filter_: SimpleFilter | None = self
        while filter_ is not None and filter_.node is None:
            filter_ = filter_._source
        executor = None if filter_ is None else filter_.node.executor
        if executor is None:
            coroutine.close()
            name = getattr(callback, "__qualname__", repr(callback))
            raise RuntimeError(
                f"no executor can run the coroutine function {name}: the messages of its filter come from no "
                "message_filters.Subscriber whose node is in an executor"
            )
        executor.create_task(coroutine)

    def unregisterCallback(self, conn: int) -> None:
        """Forget a callback. One that is not registered is fine."""
        self.callbacks.pop(conn, None)


_ADVICE = (
    "without timestamp infomation when 'allow_headerless' is disabled. auto assign ROSTIME to headerless "
    "messages once enabling constructor option of 'allow_headerless'."
)


def stamp_of(msg: Any, allow_headerless: bool, logger: str, start_of_warning: str) -> Time | None:
    """Return the time in the header of a message, or the time now if it has none and that is allowed.

    Otherwise warns, in upstream's words, and returns None. A stamp may be a message or a `Time`.
    """
    if hasattr(msg, "header") and hasattr(msg.header, "stamp"):
        stamp = msg.header.stamp
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    log = get_logger(logger)
    log.set_level(LoggingSeverity.INFO)
    log.warning(f"{start_of_warning} {_ADVICE}")
    return None


class Subscriber(SimpleFilter):
    """Passes on the messages of a topic.

    `kwargs` are those of `Node.create_subscription`, such as `callback_group`. Attributes that a filter lacks
    are those of the subscription.
    """

    def __init__(
        self,
        node: Node,
        msg_type: type[Any],
        topic: str,
        qos_profile: QoSProfile | int = QoSProfile(depth=10),  # noqa: B008 - upstream's default; nobody changes it
        **kwargs: Any,
    ) -> None:
        super().__init__()
        self.node = node
        self.topic = topic
        self.sub = node.create_subscription(
            msg_type=msg_type, topic=topic, callback=self.callback, qos_profile=qos_profile, **kwargs
        )

    def callback(self, msg: Any) -> None:
        """Pass on a message of the topic."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the name of the topic, as it was given."""
        return self.topic

    def __getattr__(self, key: str) -> Any:
        if key == "sub":  # not yet there, or never, if the subscription failed
            raise AttributeError(f"'{type(self).__name__}' object has no attribute 'sub'")
        return getattr(self.sub, key)


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
        stamp = stamp_of(
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


class Chain(SimpleFilter):
    """Passes messages through filters, the first one added first, and passes on what the last one does."""

    @dataclass
    class FilterInfo:
        """A filter of a chain, and the number of the callback that connects it with the next."""

        message_filter: Any
        connection_callback_index: int

    def __init__(self, message_filter: SimpleFilter | None = None) -> None:
        super().__init__()
        self.incoming_connection: int | None = None
        self._message_filters: dict[int, Chain.FilterInfo] = {}
        if message_filter is not None:
            self.connectInput(message_filter)

    def connectInput(self, message_filter: SimpleFilter) -> None:
        """Take the output of a filter in. Raises RuntimeError for a second one."""
        if self.incoming_connection is not None:
            raise RuntimeError("Already connected")
        self.incoming_connection = message_filter.registerCallback(self.add)

    def add(self, message: Any) -> None:
        """Take a message in."""
        if self._message_filters:
            self._message_filters[0].message_filter.add(message)
        else:
            self.signalMessage(message)

    def addFilter(self, message_filter: Any) -> None:
        """Append a filter with a method `add`."""
        index = len(self._message_filters)
        connection = message_filter.registerCallback(self.signalMessage)
        self._message_filters[index] = Chain.FilterInfo(message_filter, connection)
        if index > 0:
            last = self._message_filters[index - 1]
            last.message_filter.callbacks.pop(last.connection_callback_index)
            last.connection_callback_index = last.message_filter.registerCallback(message_filter.add)

    def getFilter(self, index: int) -> Any:
        """Return a filter by its number, from 0. Raises KeyError if there is none."""
        return self._message_filters[index].message_filter
