"""ROS domains for tests: each is used by one test or process on this machine at a time."""

from __future__ import annotations

import itertools
import os
import socket
from collections.abc import Generator
from contextlib import contextmanager

DOMAINS = 101
"""DDS has ports for the domains 0 to 101 on every system; 0 is everybody's."""

_numbers = itertools.count(37 * os.getpid())  # Processes that begin together look at different places first.


def private_domain() -> int:
    """Return the next domain: for a transport that nobody beyond this process hears."""
    return 1 + next(_numbers) % DOMAINS


@contextmanager
def own_domain() -> Generator[int, None, None]:
    """Keep a domain that no other test on this machine has, in whatever project.

    What says that it is taken is a UDP port of its range which DDS does not use. Generated tests look at the
    same ports.

    Raises RuntimeError if all are taken.
    """
    for _ in range(DOMAINS):
        domain = private_domain()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
            try:
                port.bind(("127.0.0.1", 7409 + 250 * domain))
            except OSError:
                continue
            yield domain
            return
    raise RuntimeError(f"all {DOMAINS} ROS domains are in use by other tests on this machine")
