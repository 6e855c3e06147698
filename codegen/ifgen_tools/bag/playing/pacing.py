"""The clock of `ifgen bag play`: where the play is in the bag, as steady time passes."""

from __future__ import annotations

from collections.abc import Callable


class PlayClock:
    """Maps steady time to the time of the bag, both in nanoseconds. It can be paused, sped up and moved."""

    def __init__(
        self, steady_now: Callable[[], int], start: int, rate: float = 1.0, *, is_paused: bool = False
    ) -> None:
        """Start at the bag's time `start`; `steady_now` returns the steady time [ns]."""
        self.steady_now = steady_now
        self._bag_mark = start
        self._steady_mark = steady_now()
        self._rate = rate
        self._is_paused = is_paused

    @property
    def rate(self) -> float:
        """Seconds of the bag for each second that passes."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self.jump(self.now())
        self._rate = rate

    @property
    def is_paused(self) -> bool:
        """Whether the time of the bag stands still."""
        return self._is_paused

    def now(self) -> int:
        """The time of the bag."""
        if self._is_paused:
            return self._bag_mark
        return self._bag_mark + int((self.steady_now() - self._steady_mark) * self._rate)

    def wait(self, bag_time: int) -> float | None:
        """Seconds of steady time until the bag's time; 0 if it has passed, None while paused."""
        if self._is_paused:
            return None
        due = self._steady_mark + round((bag_time - self._bag_mark) / self._rate)
        return max(due - self.steady_now(), 0) / 1e9

    def pause(self) -> None:
        """Stand still from now on."""
        self.jump(self.now())
        self._is_paused = True

    def resume(self) -> None:
        """Go on from where it stands."""
        self._steady_mark = self.steady_now()
        self._is_paused = False

    def jump(self, bag_time: int) -> None:
        """Go on from another time of the bag."""
        self._bag_mark = bag_time
        self._steady_mark = self.steady_now()
