"""Blocks that Ctrl-C and SIGTERM end at once, or in their own time."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager
from typing import Any

import pytest
from ifgen.signals import Terminated, defer_interrupt, delay_interrupt, signals_raise, sigterm_raises

RAISED = [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)]


@pytest.fixture(autouse=True)
def handlers() -> Generator[None]:
    """The handlers of a command, which must be there again after each block."""
    with sigterm_raises():
        before = [signal.getsignal(number) for number, _ in RAISED]
        yield
        assert [signal.getsignal(number) for number, _ in RAISED] == before


@pytest.mark.parametrize(("number", "kind"), RAISED)
@pytest.mark.parametrize(
    ("block", "signals"),
    [
        (signals_raise, 1),
        (lambda: delay_interrupt(""), 2),
        (defer_interrupt, 2),
        (lambda: defer_interrupt(patience=2), 3),
    ],
    ids=["raise", "delay", "defer", "defer twice"],
)
def test_ends_at_once(
    block: Callable[[], AbstractContextManager[Any]], signals: int, number: int, kind: type[BaseException]
) -> None:
    """Each signal raises what it raises anywhere: the first, or the one that shows impatience."""
    with pytest.raises(KeyboardInterrupt) as raised, block():
        for _ in range(signals - 1):
            signal.raise_signal(number)
        with pytest.raises(kind) as at_once:
            signal.raise_signal(number)
        raise at_once.value
    assert raised.type is kind


@pytest.mark.parametrize(("number", "kind"), RAISED)
def test_ends_in_its_own_time(number: int, kind: type[BaseException]) -> None:
    done = []
    with pytest.raises(KeyboardInterrupt, match="done") as raised, delay_interrupt("done"):
        signal.raise_signal(number)
        done.append(1)
    assert (raised.type, done) == (kind, [1])

    with defer_interrupt() as interrupt:
        assert interrupt.number == 0
        signal.raise_signal(number)
    assert (interrupt.number, interrupt.count) == (number, 1)
    with pytest.raises(KeyboardInterrupt) as raised:
        interrupt.raise_again()
    assert raised.type is kind
