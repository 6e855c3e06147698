"""How long time in lockstep waits for set-points, in seconds of a wall clock that the caller reads."""

from __future__ import annotations

from typing import Final

_PATIENT: Final = 3.0  # times as long as answers took lately: more than a busy node needs
_FORGETTING: Final = 0.98  # of a slow answer, with each later one


class Waiting:
    """Waits `patience` once, and after that about as long as answers used to take, until one comes again.

    While one node is silent, the others still work on the readings. Time that ran ahead of them would leave
    them nothing to catch the robot with.
    """

    def __init__(self) -> None:
        self.alone = False
        """Whether nobody answers any longer."""
        self._slow = 0.0
        self._sent = 0.0

    def begin(self, now: float) -> None:
        """Readings have been sent that ask for an answer."""
        self._sent = now

    def answered(self, now: float) -> None:
        """Somebody has answered readings, the newest or earlier ones."""
        self.alone = False
        self._slow = max(now - self._sent, _FORGETTING * self._slow)

    def is_over(self, now: float, patience: float) -> bool:
        """Whether time goes on without an answer."""
        longest = min(_PATIENT * self._slow, patience) if self.alone else patience
        return now - self._sent > longest
