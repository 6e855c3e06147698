"""How long time in lockstep waits for set-points, in seconds of a wall clock that the caller reads.

A process that gets no processor time, or that is busy with a slow callback, hears nobody, and those who share
it with the simulator cannot answer. So of the time between two looks only a little counts as waiting.
"""

from __future__ import annotations

from typing import Final

_PATIENT: Final = 3.0  # times as long as answers took lately: more than a busy node needs
_FORGETTING: Final = 0.98  # of a slow answer, with each later one
_LOOK: Final = 0.02  # s between two looks that count at most


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
        self._looked = 0.0
        self._waited = 0.0  # since then

    def begin(self, now: float) -> None:
        """Readings have been sent that ask for an answer."""
        self._sent = self._looked = now
        self._waited = 0.0

    def answered(self, now: float) -> None:
        """Somebody has answered readings, the newest or earlier ones."""
        self.alone = False
        self._slow = max(now - self._sent, _FORGETTING * self._slow)

    def is_over(self, now: float, patience: float) -> bool:
        """Whether time goes on without an answer."""
        self._waited += min(now - self._looked, _LOOK)
        self._looked = now
        if self.alone:
            return now - self._sent > min(_PATIENT * self._slow, patience)
        return self._waited > patience
