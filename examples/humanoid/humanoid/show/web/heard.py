"""What was heard of topics, and how often per simulated second."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # it imports the messages of ROS
    from .readings import Reading

_WINDOW = 5.0  # s of simulated time over which rates are measured
_LONGEST = 100  # checks, if time hardly passes


class Heard:
    """The messages of a topic."""

    def __init__(self, reading: Reading | None) -> None:
        self.reading = reading
        self.subscription: Any = None
        self.messages = 0
        self._new: deque[bytes] = deque(maxlen=1)

    def hear(self, data: bytes) -> None:
        """Count a message; only those that are shown will be read."""
        self.messages += 1
        if self.reading is not None:
            self._new.append(data)

    def take(self) -> list[bytes]:
        """The newest message, if one has come since the last call."""
        new = list(self._new)
        self._new.clear()
        return new


@dataclass(frozen=True, slots=True)
class _Counts:
    """How many messages had come by a moment of real and simulated time [s]."""

    real: float
    simulated: float
    counts: Mapping[str, int]


class Rates:
    """Measures rates over the last seconds of simulated time."""

    def __init__(self) -> None:
        self._counted: deque[_Counts] = deque(maxlen=_LONGEST)

    def count(self, real: float, simulated: float, counts: Mapping[str, int]) -> None:
        """Take how many messages have come so far, by topic."""
        if self._counted and simulated < self._counted[-1].simulated:
            self._counted.clear()  # time has gone back
        self._counted.append(_Counts(real, simulated, dict(counts)))
        while len(self._counted) > 2 and simulated - self._counted[1].simulated >= _WINDOW:
            self._counted.popleft()

    @property
    def factor(self) -> float | None:
        """Simulated seconds per second since the check before the last one; None before there was one."""
        if len(self._counted) < 2:
            return None
        before, now = self._counted[-2], self._counted[-1]
        return (now.simulated - before.simulated) / max(now.real - before.real, 1e-3)

    def per_second(self) -> dict[str, float]:
        """Messages per simulated second, by topic; nothing if no time has passed."""
        if not self._counted:
            return {}
        first, last = self._counted[0], self._counted[-1]
        passed = last.simulated - first.simulated
        if passed <= 0:
            return {}
        return {name: (last.counts[name] - count) / passed for name, count in first.counts.items()}
