"""Where the CPU time of a run goes: a look at the stack every few milliseconds of CPU time.

Wrappers round functions would cost more than much of what they measure; looks cost next to nothing. They come
at the kernel's rate, a few hundred a second, so a share of p in n looks is known to about sqrt(p / n).
"""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

_PERIOD = 0.001  # s; the kernel makes it a tick of its own

Classify = Callable[[FrameType], Any]
"""Says what a stack is about, innermost frame first."""


@dataclass(slots=True)
class Samples:
    """How often each answer came, and how much CPU time there was [s]."""

    counts: Counter[Any] = field(default_factory=Counter)
    cpu: float = 0.0

    def seconds(self, chosen: Callable[[Any], bool]) -> float:
        """CPU time of the answers that are chosen."""
        total = sum(self.counts.values())
        return self.cpu * sum(n for answer, n in self.counts.items() if chosen(answer)) / total


@contextmanager
def sampled(classify: Classify) -> Generator[Samples]:
    """Ask `classify` for as long as the block runs, on the main thread."""
    samples = Samples()

    def look(number: int, frame: FrameType | None) -> None:
        if frame is not None:
            samples.counts[classify(frame)] += 1

    before = signal.signal(signal.SIGPROF, look)
    began = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, _PERIOD, _PERIOD)
    try:
        yield samples
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        samples.cpu = time.process_time() - began
        signal.signal(signal.SIGPROF, before)
