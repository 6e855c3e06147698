"""How processes of one user on one machine notice each other, before any of them has opened a session.

Each process has a datagram socket in a folder of the user and the domain. Who comes rings at all the others.
A socket whose process is gone refuses, and is removed. So no daemon, no port and no multicast is needed, and
a process that stays alone pays for one socket and one sleeping thread.
"""

from __future__ import annotations

import _socket  # socket itself takes 3 ms to import, with enums and selectors
import os
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from rmw_local.transports.errors import TransportError

IS_POSSIBLE: Final = hasattr(_socket, "AF_UNIX") and hasattr(os, "getuid")
"""Whether the system has such sockets; Python on Windows has none."""

_BELL, _DOOR = ".bell", ".zenoh"
_RING, _HANG_UP = b"r", b"h"
# The same for all terminals and services of a user, unlike $TMPDIR and $XDG_RUNTIME_DIR.
_TEMPORARY: Final = Path("/tmp")


class Doorbell:
    """The socket of this process in one domain. Raises TransportError if there can be none."""

    def __init__(self, domain: int) -> None:
        self._folder = _own_folder(domain)
        self._name, self._socket = _bound_socket(self._folder)

    @property
    def endpoint(self) -> str:
        """Where a session of this process listens, as Zenoh writes it."""
        return _endpoint(self._folder / f"{self._name}{_DOOR}")

    def others(self) -> list[str]:
        """Where sessions of other processes listen, or are about to."""
        return [_endpoint(self._folder / f"{name}{_DOOR}") for name in self._names()]

    def ring(self) -> bool:
        """Tell all others that this process is here; returns whether there are any."""
        answers = [self._rings_at(name) for name in self._names()]  # all of them, not only the first
        return any(answers)

    def listen(self, rung: Callable[[], None]) -> None:
        """Call `rung` whenever another process comes, until the bell is closed."""
        while True:
            try:
                received = self._socket.recv(1)
            except OSError:
                return
            if received == _HANG_UP:
                return
            rung()

    def close(self) -> None:
        """Remove it. Who listens returns."""
        with suppress(OSError):
            self._socket.sendto(_HANG_UP, str(self._bell(self._name)))
        self._remove(self._name)

    def abandon(self) -> None:
        """Close this process's copy of the socket, after a fork."""
        self._socket.close()

    def _names(self) -> list[str]:
        """The names of all others, some of which may be gone."""
        names = {path.stem for path in self._folder.glob(f"*{_BELL}")}
        return sorted(names - {self._name})

    def _rings_at(self, name: str) -> bool:
        try:
            self._socket.sendto(_RING, _socket.MSG_DONTWAIT, str(self._bell(name)))
        except BlockingIOError:
            return True  # it has been told often enough
        except ConnectionRefusedError:
            self._remove(name)  # its process was killed
            return False
        except OSError:
            return False
        return True

    def _bell(self, name: str) -> Path:
        return self._folder / f"{name}{_BELL}"

    def _remove(self, name: str) -> None:
        for ending in (_BELL, _DOOR, f"{_DOOR}.lock"):
            with suppress(OSError):
                (self._folder / f"{name}{ending}").unlink()


def _endpoint(path: Path) -> str:
    return f"unixsock-stream/{path}"


def _own_folder(domain: int) -> Path:
    """The folder of this user and domain, which nobody else can look into."""
    base = _TEMPORARY / f"ifgen-{os.getuid()}"
    try:
        base.mkdir(mode=0o700, exist_ok=True)
        status = base.lstat()
        if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
            raise TransportError(f"{base} has to be a folder that only its owner, this user, can use")
        folder = base / str(domain)
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise TransportError(f"{base} cannot be used: {error.strerror}") from None
    return folder


def _bound_socket(folder: Path) -> tuple[str, _socket.socket]:
    bell = _socket.socket(_socket.AF_UNIX, _socket.SOCK_DGRAM)
    for number in range(1000):  # processes in containers share numbers
        name = f"{os.getpid()}-{number}"
        try:
            bell.bind(str(folder / f"{name}{_BELL}"))
        except OSError:
            continue
        return name, bell
    bell.close()
    raise TransportError(f"no socket can be made in {folder}")
