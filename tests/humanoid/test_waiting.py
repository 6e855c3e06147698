"""How long lockstep waits for set-points."""

from __future__ import annotations

from humanoid.simulation.waiting import Waiting

PATIENCE = 0.5
LOOK = 0.004


def over(waiting: Waiting, begun: float, seconds: float) -> bool:
    """Whether the wait is over after some seconds in which somebody looked all the time."""
    looks = (begun + number * LOOK for number in range(1, round(seconds / LOOK) + 1))
    return [waiting.is_over(look, PATIENCE) for look in looks][-1]


def test_a_process_that_is_held_up_waits_for_nobody() -> None:
    """Nodes that share it could not have answered either, so time must not go on without them."""
    waiting = Waiting()
    waiting.begin(0.0)
    assert not any(waiting.is_over(10.0 * number, PATIENCE) for number in range(1, 21))
    assert any(waiting.is_over(200.0 + number, PATIENCE) for number in range(1, 21))


def test_a_silent_node_is_awaited_once_and_then_as_long_as_answers_take() -> None:
    waiting = Waiting()
    now = 10.0
    for _ in range(3):
        waiting.begin(now)
        now += 0.02  # a busy machine
        waiting.answered(now)
    waiting.begin(now)
    assert not over(waiting, now, 0.48)
    waiting.begin(now)
    assert over(waiting, now, 0.52)
    waiting.alone = True
    waiting.begin(now)
    assert not waiting.is_over(now + 0.05, PATIENCE)  # others may still be at the last readings
    assert waiting.is_over(now + 0.07, PATIENCE)
    waiting.answered(now + 0.08)
    assert not waiting.is_over(now + 0.49, PATIENCE)


def test_one_slow_answer_is_forgotten() -> None:
    waiting = Waiting()
    waiting.begin(0.0)
    waiting.answered(8.0)  # while processes start
    waiting.begin(10.0)
    waiting.alone = True
    assert not waiting.is_over(10.4, PATIENCE)
    assert waiting.is_over(10.6, PATIENCE)
    for number in range(1000):
        waiting.begin(20.0 + number)
        waiting.answered(20.001 + number)
    waiting.begin(2000.0)
    waiting.alone = True
    assert waiting.is_over(2000.01, PATIENCE)
