"""ROS domain ids for tests: each is used by one process on this machine at a time, whatever checkout it tests."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows, where no real ROS is tested
    fcntl = None  # type: ignore[assignment]

LAST = 101  # Above it, the ports of DDS lie among those that Linux hands out to anybody.

_held: list[int] = []  # Open files. Their locks end with this process.


def claim() -> int:
    """Return a domain from 1 to 101 that nobody else uses, for as long as this process lives."""
    start = 37 * os.getpid()  # Processes that begin together look at different places first.
    for number in range(LAST):
        domain = 1 + (start + number) % LAST
        if fcntl is None:
            return domain
        lock = Path(tempfile.gettempdir()) / f"ifgen-test-domain-{domain}.lock"
        file = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(file)
        else:
            _held.append(file)
            return domain
    raise RuntimeError(f"all {LAST} ROS domains are taken by other tests on this machine")
