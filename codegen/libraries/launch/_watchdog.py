"""A process that ends what a launch has started if the launch itself is killed.

It reads groups of processes from stdin, `+PGID` and `-PGID`. When stdin ends, it interrupts those that are
left, and kills them after two seconds. Run as a file, by a Python that imports as little as possible.
"""

import os
import signal
import sys
import time
from contextlib import suppress


def main() -> None:
    """Watch until stdin ends."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    groups: set[int] = set()
    for line in sys.stdin:
        (groups.add if line[0] == "+" else groups.discard)(int(line[1:]))
    send(groups, signal.SIGINT)
    end = time.monotonic() + 2.0
    while groups and time.monotonic() < end:
        groups = {group for group in groups if is_there(group)}
        time.sleep(0.05)
    send(groups, signal.SIGKILL)


def send(groups: "set[int]", number: int) -> None:
    """Send a signal to groups, some of which may have ended."""
    for group in groups:
        with suppress(OSError):
            os.killpg(group, number)


def is_there(group: int) -> bool:
    """Return whether a group has processes."""
    try:
        os.killpg(group, 0)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()
