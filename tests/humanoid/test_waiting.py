"""How long lockstep waits for set-points."""

from __future__ import annotations

from humanoid.simulation.waiting import Waiting

PATIENCE = 0.5


def test_a_silent_node_is_awaited_once_and_then_as_long_as_answers_take() -> None:
    waiting = Waiting()
    now = 10.0
    for _ in range(3):
        waiting.begin(now)
        now += 0.02  # a busy machine
        waiting.answered(now)
    waiting.begin(now)
    assert not waiting.is_over(now + 0.49, PATIENCE)
    assert waiting.is_over(now + 0.51, PATIENCE)
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
