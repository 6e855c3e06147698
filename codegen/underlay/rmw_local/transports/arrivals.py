"""Which messages of one publisher have come to one subscription, and which must have been lost."""

from __future__ import annotations


class Arrivals:
    """The numbers of messages, which a publisher counts one by one."""

    __slots__ = ("last", "newest_lost")

    def __init__(self, first: int) -> None:
        """Begin with the first message that came: nobody misses those before it."""
        self.last = first
        self.newest_lost = 0

    def note(self, number: int) -> int:
        """Note a message; returns how many have been lost since the one before it.

        One that comes twice, or late, tells of no loss.
        """
        lost = number - self.last - 1
        if lost > 0:
            self.newest_lost = number - 1
        if lost >= 0:
            self.last = number
        return max(lost, 0)
