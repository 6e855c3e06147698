"""How processes of one user on one machine notice each other, before any of them has opened a session.

Each process has a datagram socket in a folder of the user and the domain. Who comes rings at all the others.
A socket whose process is gone refuses, and is removed. So no daemon, no port and no multicast is needed, and
a process that stays alone pays for one socket and one sleeping thread.
"""

from __future__ import annotations

import _socket  # socket itself takes 3 ms to import, with enums and selectors
import errno
import os
import re
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen_runtime.domains.neighbours import BELL, COUNT, FOLDER

from rmw_local.transports import TransportError

if TYPE_CHECKING:
    from pathlib import Path


def own_name() -> str:
    """The name of the user's folders."""
    return f"ifgen-{os.getuid()}"


def own_folder(base: Path) -> Path:
    """The user's folder in `base`, which nobody else can look into. Raises TransportError."""
    folder = base / own_name()
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError as error:
        raise TransportError(f"{folder} cannot be used: {error.strerror}") from None
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise TransportError(f"{folder} has to be a folder that only its owner, this user, can use")
    return folder


IS_POSSIBLE: Final = hasattr(_socket, "AF_UNIX") and hasattr(os, "getuid")
"""Whether the system has such sockets; Python on Windows has none."""

CLOCK: Final = ".clock"
"""The ending of sockets of processes with a clock of their own; those of the others end in BELL."""

_DOOR: Final = ".zenoh"
_RING: Final = b"r"
_NAME: Final = re.compile(r"\d{1,10}-\d{1,3}", re.ASCII)  # process id, and a number
# The same for all terminals and services of a user, unlike $TMPDIR and $XDG_RUNTIME_DIR. Services of the
# system, cron and `su` have no XDG_RUNTIME_DIR, and the last logout removes it, whatever still runs.
_TEMPORARY: Final = FOLDER


class Doorbell:
    """The socket of this process in one domain. Raises TransportError if there can be none."""

    def __init__(self, domain: int, ending: str = BELL) -> None:
        self._ending = ending
        self._folder = _domain_folder(domain)
        self._is_closed = False
        self._name, self._socket = _bound_socket(self._folder, ending)

    @property
    def endpoint(self) -> str:
        """Where a session of this process listens, as Zenoh writes it."""
        return _endpoint(self._folder / f"{self._name}{_DOOR}")

    def others(self) -> list[str]:
        """Where sessions of other processes listen, or are about to."""
        return [_endpoint(self._folder / f"{name}{_DOOR}") for name in self._names()]

    def ring(self) -> int:
        """Tell all others that this process is here; returns how many there are."""
        return sum(self._rings_at(name) for name in self._names())

    def is_beside(self, *endings: str) -> bool:
        """Whether other processes have sockets with one of these endings; nobody is rung at."""
        return any(
            _is_held(self._folder / f"{name}{ending}") for ending in endings for name in self._names(ending)
        )

    def listen(self, rung: Callable[[], None], count_nodes: Callable[[], int] = lambda: 0) -> None:
        """Call `rung` whenever another process comes, and answer whoever counts nodes, until it is closed."""
        while True:
            try:
                received, address = self._socket.recvfrom(len(_RING) + 1)
            except OSError:
                return
            if self._is_closed:
                return
            if received == _RING:  # what is neither this nor COUNT is not ours
                rung()
            elif received == COUNT and address:  # who sends without a name cannot be answered
                with suppress(OSError):
                    self._socket.sendto(b"%d" % count_nodes(), _socket.MSG_DONTWAIT, address)

    def close(self) -> None:
        """Remove it. Who listens returns."""
        self._is_closed = True
        with suppress(OSError):  # where the queue is full, there is something to wake up for
            self._socket.sendto(b"", _socket.MSG_DONTWAIT, str(self._bell(self._name)))
        self._remove(self._name)

    def abandon(self) -> None:
        """Close this process's copy of the socket, after a fork."""
        self._socket.close()

    def _names(self, ending: str = BELL) -> list[str]:
        """The names of all others, some of which may be gone. What has no such name is not ours."""
        found = (path.stem for path in self._folder.glob(f"*{ending}") if _is_socket(path))
        return sorted(name for name in found if _NAME.fullmatch(name) and name != self._name)

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
        return self._folder / f"{name}{BELL}"

    def _remove(self, name: str) -> None:
        for ending in (self._ending, _DOOR, f"{_DOOR}.lock"):
            with suppress(OSError):
                (self._folder / f"{name}{ending}").unlink()


def _is_socket(path: Path) -> bool:
    try:
        return stat.S_ISSOCK(path.lstat().st_mode)
    except OSError:  # gone meanwhile
        return False


def _endpoint(path: Path) -> str:
    return f"unixsock-stream/{path}"


def _domain_folder(domain: int) -> Path:
    folder = own_folder(_TEMPORARY) / str(domain)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise TransportError(f"{folder} cannot be used: {error.strerror}") from None
    return folder


def _is_held(path: Path) -> bool:
    """Whether a process has this socket open; if not, it is removed."""
    asking = _socket.socket(_socket.AF_UNIX, _socket.SOCK_DGRAM)
    try:
        asking.connect(str(path))
    except ConnectionRefusedError:
        with suppress(OSError):
            path.unlink()
        return False
    except OSError:
        return False
    finally:
        asking.close()
    return True


def _bound_socket(folder: Path, ending: str) -> tuple[str, _socket.socket]:
    bell = _socket.socket(_socket.AF_UNIX, _socket.SOCK_DGRAM)
    reason = "all names are taken"
    for number in range(1000):  # processes in containers share numbers
        name = f"{os.getpid()}-{number}"
        try:
            bell.bind(str(folder / f"{name}{ending}"))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                continue
            reason = str(error.strerror)
            break
        return name, bell
    bell.close()
    raise TransportError(f"no socket can be made in {folder}: {reason}")
