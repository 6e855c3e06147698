"""`ifgen topic hz`, `bw` and `delay`: figures about the messages of topics."""

from __future__ import annotations

import json
import math
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen_runtime.field_types import fields_of, type_name

from ifgen_tools.qos import QosChoice
from ifgen_tools.session import Session, open_session
from ifgen_tools.texts.formats import condition
from ifgen_tools.topic import topics
from ifgen_tools.topic.options import HzOptions, RateOptions

_SECOND: Final = 1_000_000_000  # [ns]


@dataclass(frozen=True, slots=True)
class Spread:
    """The mean of values, the lowest and the highest one, their standard deviation, and how many they are."""

    mean: float
    lowest: float
    highest: float
    deviation: float
    count: int


def spread(values: Sequence[float]) -> Spread:
    """The spread of at least one value."""
    mean = math.fsum(values) / len(values)
    variance = math.fsum((value - mean) ** 2 for value in values) / len(values)
    return Spread(mean, min(values), max(values), math.sqrt(variance), len(values))


class Rate:
    """The rate of one topic, over the intervals [ns] of a window of messages."""

    def __init__(self, window: int) -> None:
        self._intervals: deque[int] = deque(maxlen=window)
        self._last: int | None = None
        self._told = 0

    def add(self, now: int) -> bool:
        """Note that a message has come at a time [ns]; returns False if time has begun again."""
        before, self._last = self._last, now
        if before is None:
            self._told = now
        elif now < before:
            self._intervals.clear()
            self._told = now
            return False
        else:
            self._intervals.append(now - before)
        return True

    def take(self) -> Spread | None:
        """The spread of intervals [s], once for each second in which messages have come."""
        if not self._intervals or self._last is None or self._last < self._told + _SECOND:
            return None
        self._told = self._last
        return spread([interval / _SECOND for interval in self._intervals])


def hz(chosen: HzOptions) -> int:
    """Print rates every second."""
    wanted = condition(chosen.filter_expression)
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        now: Callable[[], int] = time.time_ns if chosen.wall_time else session.now
        rates: dict[str, Rate] = {}

        def hear(rate: Rate, message: Any) -> None:
            if chosen.filter_expression and not wanted(message):
                return
            moment = now()
            if moment and not rate.add(moment):
                print("time has reset, resetting counters", flush=True)

        names = [topics.find_topic(session, name, chosen.spin_time) for name in chosen.names]
        for name in dict.fromkeys(names):
            rate = rates[name] = Rate(chosen.window)
            cls = topics.wait_for_topic(session, name)
            topics.listen(
                session, name, cls, partial(hear, rate), QosChoice(), raw=not chosen.filter_expression
            )
        while True:
            session.turn()
            told = {name: found for name, rate in rates.items() if (found := rate.take()) is not None}
            for name, found in told.items():
                shown = name if len(rates) > 1 or chosen.as_json else ""
                print(_rate_text(shown, found, chosen.as_json), flush=True)


def _rate_text(topic: str, found: Spread, as_json: bool) -> str:
    rate = 1 / found.mean if found.mean > 0 else 0.0
    if as_json:
        return _json(topic, {"rate": rate}, found)
    return f"{topic}{': ' if topic else ''}average rate: {rate:.3f}\n{_deltas(found)}"


def _deltas(found: Spread) -> str:
    return (
        f"\tmin: {found.lowest:.3f}s max: {found.highest:.3f}s std dev: {found.deviation:.5f}s "
        f"window: {found.count}"
    )


def _json(topic: str, figures: dict[str, float], found: Spread) -> str:
    limits = {"min": found.lowest, "max": found.highest, "std_dev": found.deviation, "window": found.count}
    return json.dumps({"topic": topic, **figures, **limits})


@dataclass(frozen=True, slots=True)
class _Arrival:
    at: int  # [ns]
    size: int  # [bytes]


def bw(chosen: RateOptions) -> int:
    """Print the bandwidth every second."""
    arrivals: deque[_Arrival] = deque(maxlen=chosen.window)
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        topic = topics.find_topic(session, chosen.name, chosen.spin_time)

        def hear(data: bytes) -> None:
            arrivals.append(_Arrival(session.now(), len(data)))

        def tell() -> None:
            now = session.now()
            if len(arrivals) < 2:
                return
            if now <= arrivals[0].at:
                print("WARNING: time is reset!", file=sys.stderr, flush=True)
                arrivals.clear()
                return
            sizes = [arrival.size for arrival in arrivals]
            print(_bandwidth_text(topic, sizes, (now - arrivals[0].at) / _SECOND, chosen.as_json), flush=True)

        cls = topics.wait_for_topic(session, topic)
        topics.listen(session, topic, cls, hear, QosChoice(), raw=True)
        if not chosen.as_json:
            print(f"Subscribed to [{topic}]", flush=True)
        _every_second(session, tell)
    return 0


def _bandwidth_text(topic: str, sizes: list[int], seconds: float, as_json: bool) -> str:
    found = spread(sizes)
    rate = sum(sizes[1:]) / seconds  # the time begins with the first one
    if as_json:
        return _json(topic, {"bytes_per_second": rate, "mean": found.mean}, found)
    factor, unit, digits = (1, "B", 0) if rate < 1e3 else (1e3, "KB", 2) if rate < 1e6 else (1e6, "MB", 2)

    def shown(size: float) -> str:
        return f"{size / factor:.{digits}f} {unit}"

    sizes_text = f"mean: {shown(found.mean)} min: {shown(found.lowest)} max: {shown(found.highest)}"
    return f"{shown(rate)}/s from {found.count} messages\n\tMessage size {sizes_text}"


def delay(chosen: RateOptions) -> int:
    """Print every second how old messages are by the stamps in their headers."""
    delays: deque[float] = deque(maxlen=chosen.window)  # [s]
    fresh: list[bool] = []
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        topic = topics.find_topic(session, chosen.name, chosen.spin_time)

        def hear(message: Any) -> None:
            now, stamp = session.now(), message.header.stamp
            if now:
                delays.append((now - stamp.sec * _SECOND - stamp.nanosec) / _SECOND)
                fresh[:] = [True]

        def tell() -> None:
            if not delays:
                return
            if not fresh:
                print("no new messages", file=sys.stderr if chosen.as_json else sys.stdout, flush=True)
                return
            fresh.clear()
            found = spread(delays)
            text = _json(topic, {"delay": found.mean}, found) if chosen.as_json else ""
            print(text or f"average delay: {found.mean:.3f}\n{_deltas(found)}", flush=True)

        cls = topics.wait_for_topic(session, topic)
        if not any(f.name == "header" and f.element == "std_msgs/msg/Header" for f in fields_of(cls)):
            raise ToolError(f"{type_name(cls)} has no header, so {topic!r} has no times to compare with")
        topics.listen(session, topic, cls, hear, QosChoice())
        _every_second(session, tell)
    return 0


def _every_second(session: Session, tell: Callable[[], None]) -> None:
    """Spin for ever, and call a function every second."""
    session.node.create_timer(1.0, tell)
    session.wait_for(lambda: False)
