"""Partial states of joints, from several drivers, into whole ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..data import SECOND, JointStates
from ..spatial import Array


class JointCollector:
    """Collects the values of joints; a round is over when every driver has reported since the last one.

    `joints` are the names in the order that is wanted. A driver that has been silent for `stale_after` [ns]
    holds up no round.
    """

    def __init__(self, joints: Sequence[str], stale_after: int = SECOND // 2) -> None:
        self.names = list(joints)
        self._stale_after = stale_after
        self._places = {name: place for place, name in enumerate(self.names)}
        self._values = np.full((3, len(self.names)), np.nan)  # position, velocity, effort
        self._reported = np.full(len(self.names), -1, dtype=np.int64)  # when, ns
        self._told: int | None = None  # the stamp of the last round

    @property
    def stale(self) -> list[str]:
        """The joints that have not been reported for too long, or never."""
        if not self._reported.size:
            return []
        limit = int(self._reported.max()) - self._stale_after
        return [name for name, when in zip(self.names, self._reported.tolist(), strict=True) if when < limit]

    def take(
        self, stamp: int, names: Sequence[str], position: Array, velocity: Array, effort: Array
    ) -> JointStates | None:
        """Take what a driver reports; returns the states of all joints if the round is over.

        Values that are missing altogether are NaN. Raises ValueError for sizes that do not fit, and for
        joints that nobody has asked for.
        """
        places = self._places_of(names)
        for row, values in zip(self._values, (position, velocity, effort), strict=True):
            if len(values) not in (0, len(names)):
                raise ValueError(f"{len(names)} joints, but {len(values)} values")
            if len(values):
                row[places] = values
        if self._told is None or (self._reported[places] > stamp).any():  # the start, or time went back
            self._told = stamp - 1
            self._reported[:] = self._told
        self._reported[places] = stamp
        awaited = self._reported[self._reported >= stamp - self._stale_after]
        if int(awaited.min()) <= self._told != stamp:  # the same moment again is a round again
            return None
        self._told = stamp
        return JointStates(stamp, *self._values.copy())

    def _places_of(self, names: Sequence[str]) -> list[int] | slice:
        if names == self.names:
            return slice(None)  # one driver for all, as in the simulation
        if unknown := [name for name in names if name not in self._places]:
            raise ValueError(f"the robot has no joint {unknown[0]!r}")
        if not names:
            raise ValueError("it names no joint")
        return [self._places[name] for name in names]
