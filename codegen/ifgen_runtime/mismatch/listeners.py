"""A listener for definitions that differ: both transports tell it, and strict mode for tests is one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ifgen_runtime.mismatch.sides import Mismatch

heard: Callable[[Mismatch], None] | None = None
"""Called for each pair of endpoints whose definitions differ, on any thread, with no lock held."""


def tell(mismatch: Mismatch) -> None:
    """Pass it on to the listener, if there is one. Each transport calls this once a pair, logged or not."""
    if heard is not None:
        heard(mismatch)
