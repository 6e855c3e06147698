"""Messages of several inputs in the order of their times."""

import heapq
import itertools
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time

from message_filters._filters import SimpleFilter

_NEVER = 2**63 - 1


@dataclass(eq=False)
class QueueStatus:
    """State of an input: whether it is waited for, and its messages that wait, went on or came too late."""

    active: bool
    queue_size: int
    msgs_processed: int
    msgs_dropped: int


class _Input:
    """The messages of an input that wait, and when the next one is due; times in nanoseconds."""

    def __init__(self) -> None:
        self.signal = SimpleFilter()
        self.waiting: list[tuple[int, int, Any]] = []
        self.period = 0
        self.active = False
        self.processed = 0
        self.dropped = 0
        self._next = _NEVER
        self._count = itertools.count()  # messages with the same time go in the order in which they came

    def push(self, time: int, msg: Any) -> None:
        heapq.heappush(self.waiting, (time, next(self._count), msg))

    def pop(self) -> tuple[int, Any]:
        time, _, msg = heapq.heappop(self.waiting)
        self.processed += 1
        return time, msg

    def first(self) -> int:
        """The time of the first message, or when it is due."""
        if self.waiting:
            first = self.waiting[0][0]
            self._next = first + self.period
            self.active = True
            return first
        return self._next if self.active else _NEVER


class InputAligner:
    """Passes on the messages of each input to callbacks of its own, in the order of the times of all.

    An input with nothing to pass on is waited for until its next message is due by its period, and for at
    most `timeout` after that, by the times of the other inputs' messages. What comes too late is dropped.
    """

    def __init__(self, timeout: Duration, filters: Sequence[SimpleFilter] | None = None) -> None:
        self.timeout = timeout
        self.last_in_ts = self.last_out_ts = Time(clock_type=ClockType.ROS_TIME)
        self.name = ""
        self.lock = threading.RLock()
        self.event_queues: list[_Input] = []
        self.input_connections: list[tuple[SimpleFilter, int]] = []
        self.dispatch_timer: Any = None
        if filters is not None:
            self.connectInput(filters=filters)

    @property
    def signals(self) -> list[SimpleFilter]:
        """The outputs, one for each input."""
        return [each.signal for each in self.event_queues]

    def connectInput(self, filters: Sequence[SimpleFilter]) -> None:
        """Take the outputs of filters in, in place of earlier ones. Callbacks are to be registered again."""
        with self.lock:
            self.disconnectAll()
            self.event_queues = [_Input() for _ in filters]
            self.input_connections = [
                (each, each.registerCallback(self.add, index)) for index, each in enumerate(filters)
            ]

    def disconnectAll(self) -> None:
        """Take nothing in any more."""
        with self.lock:
            for each, connection in self.input_connections:
                each.unregisterCallback(connection)
            self.input_connections = []

    def registerCallback(self, index: int, callback: Callable[..., Any], *args: Any) -> int:
        """Call a function with each message of an input, by its number from 0, and with `args` after it."""
        return self.event_queues[index].signal.registerCallback(callback, *args)

    def setName(self, name: str) -> None:
        """Name the filter."""
        self.name = name

    def getName(self) -> str:
        """Return the name of the filter."""
        return self.name

    def add(self, msg: Any, queue_index: int) -> None:
        """Take a message of an input in."""
        stamp = Time.from_msg(msg.header.stamp)
        with self.lock:
            queue = self.event_queues[queue_index]
            if stamp < self.last_out_ts:
                queue.dropped += 1
                return
            self.last_in_ts = max(self.last_in_ts, stamp)
            queue.push(stamp.nanoseconds, msg)

    def setInputPeriod(self, index: int, period: Duration) -> None:
        """Say how far apart the messages of an input are."""
        self.event_queues[index].period = period.nanoseconds

    def getQueueStatus(self, index: int) -> QueueStatus:
        """Return the state of an input."""
        queue = self.event_queues[index]
        return QueueStatus(queue.active, len(queue.waiting), queue.processed, queue.dropped)

    def setupDispatchTimer(self, node: Node, update_rate: Duration) -> None:
        """Let a timer of a node pass messages on."""
        self.dispatch_timer = node.create_timer(update_rate.nanoseconds / 1e9, self.dispatchMessages)

    def dispatchMessages(self) -> None:
        """Pass on all messages whose turn it is."""
        with self.lock:
            if any(queue.waiting for queue in self.event_queues):
                while self._dispatch_first():
                    pass

    def _dispatch_first(self) -> bool:
        """Pass on one message, or stop waiting for an input; False if there is nothing to do but wait."""
        firsts = [queue.first() for queue in self.event_queues]
        queue = self.event_queues[firsts.index(min(firsts))]
        if queue.waiting:
            time, msg = queue.pop()
            self.last_out_ts = Time(nanoseconds=time, clock_type=ClockType.ROS_TIME)
            queue.signal.signalMessage(msg)
            return True
        if self.last_in_ts.nanoseconds - queue.first() >= self.timeout.nanoseconds:
            queue.active = False
            return True
        return False
