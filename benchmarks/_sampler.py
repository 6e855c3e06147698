"""The CPU time of a run: a sample of the stack every few milliseconds of CPU time.

Wrappers around functions would cost more than much of what they measure; samples cost almost nothing. The
kernel takes a few hundred per second, so a share of p in n samples is known to about sqrt(p / n).
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

_PERIOD = 0.001  # s; the kernel rounds it to one of its ticks

Classify = Callable[[FrameType], Any]
"""Names the kind of work of a stack, innermost frame first."""


@dataclass(slots=True)
class Samples:
    """The number of samples of each kind, and the CPU time [s]."""

    counts: Counter[Any] = field(default_factory=Counter)
    cpu: float = 0.0

    def seconds(self, chosen: Callable[[Any], bool]) -> float:
        """CPU time of the chosen kinds."""
        total = sum(self.counts.values())
        return self.cpu * sum(n for answer, n in self.counts.items() if chosen(answer)) / total


@contextmanager
def sampled(classify: Classify) -> Generator[Samples]:
    """Call `classify` on samples while the block runs, on the main thread."""
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
