"""Messages of several inputs that belong together, by their times."""

import threading
from bisect import bisect_left
from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.time import Time

from message_filters._filters import SimpleFilter, stamp_of

_Queue = dict[int, Any]
"""Messages by their times, in nanoseconds."""


class TimeSynchronizer(SimpleFilter):
    """Passes on one message of each input, all with the same time, as soon as the last of them is there.

    For each input `queue_size` messages wait; of more, those with the earliest times are dropped. So are all
    that are older than a set that was passed on.
    """

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        # Upstream's cannot be taken twice: a callback that adds a message there waits for itself.
        self.lock = threading.RLock()
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:
        """Take the outputs of filters in, with empty queues."""
        self.queues: list[_Queue] = [{} for _ in fs]
        self.input_connections = [
            f.registerCallback(self.add, queue, index)
            for index, (f, queue) in enumerate(zip(fs, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: _Queue, my_queue_index: int | None = None) -> None:
        """Take a message of one input in."""
        with self.lock:
            self._keep(msg, Time.from_msg(msg.header.stamp).nanoseconds, my_queue)
            first, *others = self.queues
            common = [time for time in first if all(time in queue for queue in others)]
            if common:
                time = min(common)
                found = [queue.pop(time) for queue in self.queues]
                for queue in self.queues:
                    for older in [other for other in queue if other < time]:
                        del queue[older]
                self.signalMessage(*found)

    def _keep(self, msg: Any, time: int, queue: _Queue) -> None:
        queue[time] = msg
        while len(queue) > self.queue_size:
            del queue[min(queue)]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Passes on one message of each input, all with times less than `slop` seconds apart.

    A message that comes in is combined with those nearest to it in time. A message without a header has the
    time at which it came if `allow_headerless` is set; otherwise it is dropped with a warning.
    """

    def __init__(
        self, fs: Sequence[SimpleFilter], queue_size: int, slop: float, allow_headerless: bool = False
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop = Duration(seconds=slop)
        self.allow_headerless = allow_headerless

    def add(self, msg: Any, my_queue: _Queue, my_queue_index: int | None = None) -> None:
        """Take a message of one input in."""
        stamp = stamp_of(
            msg,
            self.allow_headerless,
            "message_filters_approx",
            "can not use message filters for messages",
        )
        if stamp is None:
            return
        with self.lock:
            self._keep(msg, stamp.nanoseconds, my_queue)
            own = my_queue_index
            if own is None:
                own = next(index for index, queue in enumerate(self.queues) if queue is my_queue)
            times = self._set_with(stamp.nanoseconds, own)
            if times is not None:
                found = [queue.pop(time) for queue, time in zip(self.queues, times, strict=True)]
                self.signalMessage(*found)

    def _set_with(self, own: int, own_index: int) -> list[int] | None:
        """The times of the set that a message completes, one for each input; None if it completes none."""
        if own not in self.queues[own_index]:
            return None
        slop = self.slop.nanoseconds
        others = [queue for index, queue in enumerate(self.queues) if index != own_index]
        times = _nearest(own, [[time for time in queue if abs(time - own) < slop] for queue in others], slop)
        return None if times is None else [*times[:own_index], own, *times[own_index:]]


def _nearest(own: int, inputs: Sequence[Sequence[int]], slop: int) -> list[int] | None:
    """A time of each input, all less than `slop` apart from `own` and each other; None if that cannot be.

    The first input has the time nearest to `own` with which there is such a set, then the second, and so on.
    Of two that are as near it is the one that came first. Upstream finds the same by trying all combinations.
    """
    in_order = [sorted(times) for times in inputs]
    if not _can_be_completed(own, own, in_order, slop):
        return None
    chosen: list[int] = []
    low = high = own
    for number, times in enumerate(inputs):
        for time in sorted(times, key=lambda time: abs(time - own)):
            lowest, highest = min(low, time), max(high, time)
            if _can_be_completed(lowest, highest, in_order[number + 1 :], slop):
                low, high = lowest, highest
                chosen.append(time)
                break
    return chosen


def _can_be_completed(low: int, high: int, inputs: Sequence[Sequence[int]], slop: int) -> bool:
    """Whether each input has a time that fits to those from `low` to `high` and to the other inputs'."""
    if high - low >= slop:
        return False
    starts = [low, *(time for times in inputs for time in times if high - slop < time < low)]
    return any(all(_has(times, start, start + slop) for times in inputs) for start in starts)


def _has(times: Sequence[int], start: int, end: int) -> bool:
    place = bisect_left(times, start)
    return place < len(times) and times[place] < end
