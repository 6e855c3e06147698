"""Plays messages at their recorded pace, while others pause it, step, seek and change its rate."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final, Protocol, TypeAlias

from ifgen_tools.bag.playing.pacing import PlayClock

_LOOK: Final = 0.1
"""Seconds of waiting after which whoever waits looks around: for keys, and for Ctrl-C."""

_IN_A_ROW: Final = 100
"""Messages that may follow each other before others get a chance."""


class Playable(Protocol):
    """A message of a recording, received at a time [ns]."""

    @property
    def received(self) -> int:
        """When it was received [ns]."""
        ...


Messages: TypeAlias = Callable[[int], Iterator[Any]]
"""The messages (`Playable`) from a time of the recording on [ns]."""

Wait: TypeAlias = Callable[[float], None]
"""Lets things happen for some seconds at most: answers to services, timers, keys."""


@dataclass(frozen=True, slots=True)
class Range:
    """The part of a recording to play, both ends included [ns]."""

    start: int
    end: int


def part(start: int, end: int, duration: int | None, until: int | None) -> Range:
    """The part of a recording to play [ns]: for a `duration`, or `until` a time, the later one as in ROS."""
    ends = [each for each in (None if duration is None else start + duration, until) if each is not None]
    return Range(start, min(end, max(ends, default=end)))


class Player:
    """Plays once or in a loop. All methods are called in one thread: others from what `wait` lets happen."""

    def __init__(
        self,
        messages: Messages,
        publish: Callable[[Any], None],
        wait: Wait,
        clock: PlayClock,
        span: Range,
        *,
        delay: float = 0.0,
    ) -> None:
        """Play the messages of a `span`, each round after a `delay` [s]; `publish` sends one."""
        self.clock = clock
        self._whole = self._span = span
        self._messages, self._publish, self._wait, self._delay = messages, publish, wait, delay
        self._ahead: Iterator[Any] = iter(())
        self._next: Playable | None = None
        self._target: int | None = None  # the time to seek to
        self._is_stopped = False
        self.published = 0

    @property
    def is_playing(self) -> bool:
        """Whether there are messages left."""
        return self._next is not None

    def play(self, *, is_looping: bool = False) -> None:
        """Publish all messages; return at the end, or when it is stopped."""
        while not self._is_stopped:
            self._pass_delay()
            self._target = self._span.start
            while not self._is_stopped and (target := self._sought()) is not None:
                self._play_from(target)
            if not is_looping:
                break

    def pause(self) -> None:
        """Stand still, after the message that is being published."""
        self.clock.pause()

    def resume(self) -> None:
        """Go on."""
        self.clock.resume()

    def toggle(self) -> None:
        """Pause, or go on."""
        if self.clock.is_paused:
            self.resume()
        else:
            self.pause()

    def step(self, count: int) -> int:
        """Publish `count` messages at once (0: all), if it is paused; returns how many there were."""
        done = 0
        while self.clock.is_paused and self._next is not None and (done < count or count == 0):
            self._publish_next()
            done += 1
        return done

    def seek(self, bag_time: int) -> bool:
        """Go on from a time [ns] of the recording; returns whether that is one."""
        if not self._whole.start <= bag_time <= self._whole.end:
            return False
        self._target = bag_time
        return True

    def set_rate(self, rate: float) -> bool:
        """Play faster or slower; returns whether that is possible."""
        if not (rate > 0 and math.isfinite(rate)):
            return False
        self.clock.rate = rate
        return True

    def start_over(self, offset: int, duration: int | None, until: int | None) -> bool:
        """Play from `offset` on, for a `duration` or `until` a time [ns]; whether that is possible."""
        start = self._whole.start + offset
        if not self.seek(start):
            return False
        self._span = part(start, self._whole.end, duration, until)
        self.resume()
        return True

    def stop(self) -> None:
        """End it, however much is left."""
        self._is_stopped = True

    def _pass_delay(self) -> None:
        """Let the delay pass, with the recording standing still at its start."""
        self.clock.jump(self._span.start)
        waited = PlayClock(self.clock.steady_now, 0)
        while not self._is_stopped and (left := waited.wait(round(self._delay * 1e9))):
            self._wait(min(left, _LOOK))

    def _sought(self) -> int | None:
        """Where somebody wants to go on; None if nobody sought."""
        target, self._target = self._target, None
        return target

    def _play_from(self, start: int) -> None:
        self.clock.jump(start)
        self._ahead = self._messages(start)
        self._advance()
        while self._next is not None and self._wait_for(self._next):
            pass
        self._next = None

    def _wait_for(self, message: Playable) -> bool:
        """Publish a message when it is due; returns False if somebody stopped it, or sought."""
        while self._next is message and self._target is None and not self._is_stopped:
            left = self.clock.wait(message.received)
            if left == 0:
                self._publish_next()
                if self.published % _IN_A_ROW == 0:
                    self._wait(0.0)
            else:
                self._wait(_LOOK if left is None else min(left, _LOOK))
        return self._target is None and not self._is_stopped

    def _publish_next(self) -> None:
        assert self._next is not None
        self._publish(self._next)
        self.published += 1
        if self.clock.is_paused:
            self.clock.jump(self._next.received)
        self._advance()

    def _advance(self) -> None:
        found = next(self._ahead, None)
        self._next = None if found is None or found.received > self._span.end else found
