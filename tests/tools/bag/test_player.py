"""The pace of a player, and what others do to it: with a clock that only moves when it waits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import pytest
from ifgen_tools.bag.player import PlayClock, Player, Range

S = 10**9


@dataclass(frozen=True)
class Message:
    received: int


@dataclass
class Scene:
    """Messages at these times [s] of the recording, and what was published when, in seconds that passed."""

    times: tuple[float, ...] = (10.0, 10.1, 10.5, 12.0)
    now: int = 0
    published: list[tuple[float, float]] = field(default_factory=list)
    later: dict[float, Callable[[], object]] = field(default_factory=dict)

    def player(self, rate: float = 1.0, delay: float = 0.0, is_paused: bool = False) -> Player:
        span = Range(round(self.times[0] * S), round(self.times[-1] * S))
        clock = PlayClock(lambda: self.now, span.start, rate, is_paused=is_paused)
        return Player(self.messages, self.publish, self.wait, clock, span, delay=delay)

    def messages(self, start: int) -> Iterator[Message]:
        return (Message(round(time * S)) for time in self.times if time * S >= start)

    def publish(self, message: Message) -> None:
        self.published.append((self.now / S, message.received / S))

    def wait(self, seconds: float) -> None:
        """Let time pass, up to what somebody does next."""
        end = self.now / S + seconds
        due = sorted(time for time in self.later if time <= end)
        self.now = round((due[0] if due else end) * S)
        if due:
            self.later.pop(due[0])()


def test_messages_come_as_they_were_recorded() -> None:
    scene = Scene()
    scene.player().play()
    assert scene.published == [(0.0, 10.0), (0.1, 10.1), (0.5, 10.5), (2.0, 12.0)]


def test_rate_and_delay() -> None:
    scene = Scene()
    scene.player(rate=2.0, delay=1.0).play()
    assert scene.published == [(1.0, 10.0), (1.05, 10.1), (1.25, 10.5), (2.0, 12.0)]


def test_a_pause_takes_its_time() -> None:
    scene = Scene()
    player = scene.player()
    scene.later = {0.2: player.pause, 7.2: player.resume}
    player.play()
    assert scene.published == [(0.0, 10.0), (0.1, 10.1), (7.5, 10.5), (9.0, 12.0)]


def test_steps() -> None:
    scene = Scene()
    player = scene.player(is_paused=True)
    steps: list[int] = []
    scene.later = {1.0: lambda: steps.append(player.step(1)), 2.0: lambda: steps.append(player.step(2))}
    scene.later |= {3.0: player.resume}
    player.play()
    assert steps == [1, 2]
    assert scene.published == [(1.0, 10.0), (2.0, 10.1), (2.0, 10.5), (4.5, 12.0)]


def test_nobody_steps_what_plays() -> None:
    scene = Scene()
    player = scene.player()
    steps: list[int] = []
    scene.later = {0.3: lambda: steps.append(player.step(1))}
    player.play()
    assert steps == [0]


def test_a_burst_of_all_that_is_left() -> None:
    scene = Scene()
    player = scene.player(is_paused=True)
    scene.later = {1.0: lambda: player.step(0)}
    player.play()
    assert [time for time, _ in scene.published] == [1.0] * 4


def test_seeking_back_and_forth() -> None:
    scene = Scene()
    player = scene.player()
    found: list[bool] = []
    scene.later = {0.7: lambda: found.append(player.seek(round(10.1 * S)))}
    scene.later |= {0.8: lambda: found.append(player.seek(99 * S))}
    player.play()
    assert found == [True, False]
    assert scene.published == [(0.0, 10.0), (0.1, 10.1), (0.5, 10.5), (0.7, 10.1), (1.1, 10.5), (2.6, 12.0)]


def test_a_rate_that_changes() -> None:
    scene = Scene()
    player = scene.player()
    found: list[bool] = []
    scene.later = {
        0.5: lambda: found.append(player.set_rate(3.0)),
        0.6: lambda: found.append(player.set_rate(0.0)),
    }
    player.play()
    assert found == [True, False]
    assert scene.published[-1] == (pytest.approx(1.0), 12.0)


def test_a_loop_ends_when_somebody_stops_it() -> None:
    scene = Scene()
    player = scene.player()
    scene.later = {4.05: player.stop}
    player.play(is_looping=True)
    assert [recorded for _, recorded in scene.published] == [10.0, 10.1, 10.5, 12.0] * 2 + [10.0]


def test_a_part_that_somebody_asks_for() -> None:
    scene = Scene()
    player = scene.player(is_paused=True)
    scene.later = {1.0: lambda: player.start_over(round(0.1 * S), round(0.4 * S), None)}
    player.play()
    assert scene.published == [(1.0, 10.1), (1.4, 10.5)]
