"""ROS domains for tests: each is used by one test or process on this machine at a time."""

from __future__ import annotations

import itertools
import os
import socket
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

DOMAINS = 101
"""DDS has ports for the domains 0 to 101 on every system; 0 is everybody's."""

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
"""The environment variable that says how far a context looks for others."""

_FIRST_PORT, _PORTS = 7400, 250  # of the domain 0; of each domain (DDSI-RTPS 2.5, section 9.6.2)
_SHARED_MEMORY = Path("/dev/shm")  # where Fast DDS keeps a file for each port

_numbers = itertools.count(37 * os.getpid())  # Processes that begin together look at different places first.


def private_domain() -> int:
    """Return the next domain, for a transport that stays within this process."""
    return 1 + next(_numbers) % DOMAINS


@contextmanager
def own_domain() -> Generator[int, None, None]:
    """Keep a domain that no other test on this machine has, in whatever project.

    A UDP port of the domain's range that DDS does not use marks the domain as taken. Generated tests use the
    same ports. It skips domains in which rclpy would hang.

    Raises RuntimeError if all are taken.
    """
    for _ in range(DOMAINS):
        domain = private_domain()
        if _hangs(domain):
            continue
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
            try:
                port.bind(("127.0.0.1", _FIRST_PORT + 9 + _PORTS * domain))
            except OSError:
                continue
            yield domain
            return
    raise RuntimeError(f"all {DOMAINS} ROS domains are in use by other tests on this machine")


def _hangs(domain: int) -> bool:
    """Return whether a participant of the domain would wait for ever, in C, where no time limit reaches it.

    A process that is killed while Fast DDS creates a port in shared memory leaves an empty file. Whoever
    opens that port later waits for the file to get its size.
    """
    first = _FIRST_PORT + _PORTS * domain
    return any(_is_empty(_SHARED_MEMORY / f"fastrtps_port{port}") for port in range(first, first + _PORTS))


def _is_empty(file: Path) -> bool:
    try:
        return file.stat().st_size == 0
    except OSError:
        return False
