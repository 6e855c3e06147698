"""Large messages between processes of one user on one machine, through a file in memory.

Each session has such a file. It writes a message there once, and lends it to any number of other processes.
These read it and note that beside it.

A message begins with a ticket that no other has, and a byte for each borrower, which it sets to one. A ticket
that is not there, before and after reading, means that the place was lent again.
"""

from __future__ import annotations

import _thread
import mmap
import os
import sys
import time
import weakref
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from rmw_local.notices import say
from rmw_local.transports.errors import TransportError
from rmw_local.transports.own_folder import own_folder

if sys.platform != "win32":
    import fcntl

IS_POSSIBLE: Final = sys.platform == "linux"
"""Whether the system has a folder for files in memory."""

SHARED: Final = Path("/dev/shm")
"""That folder."""

_TICKET: Final = 8  # bytes
_TICKETS: Final = 256**_TICKET
_PAGE: Final = 4096  # bytes
_STEP: Final = 1024 * 1024  # bytes that a file grows by
_EXISTING: Final = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW
_MOST_LOANS: Final = 256
# A connection is lost after ten seconds without a sign of life, and what was on its way with it.
_LONGEST: Final = 20.0  # [s] that a borrower may take
_PATIENCE: Final = 0.5  # [s] for borrowers, at the end
_BETWEEN_LOOKS: Final = 0.001  # [s]
_MOST_TRIES: Final = 3


class Loan(NamedTuple):
    """A message in somebody's file: where it is [bytes], how long it is, and how many are to read it."""

    ticket: bytes
    offset: int
    length: int
    borrowers: int

    @property
    def begin(self) -> int:
        """Where the message itself begins [bytes]."""
        return self.offset + _TICKET + self.borrowers


@dataclass(slots=True, eq=False)
class _Lent:
    """The pages of a message, until all borrowers have read it, or should have (monotonic [s])."""

    offset: int
    end: int
    borrowers: int
    until: float


class Pool:
    """The file of one session, of at most `size` bytes. Raises TransportError if there can be none.

    `name` is the session's. While its file is there and locked, others may lend to it.
    """

    def __init__(self, name: str, size: int) -> None:
        self._folder = own_folder(SHARED)
        for each in self._folder.iterdir():
            self.bury(each.name)
        self._name = name
        self._limit = size
        self._file = _locked_file(self._folder / name)
        self._memory: mmap.mmap | None = None  # of the whole file, once there is something in it
        self._lent: list[_Lent] = []  # by offset
        self._ticket = int.from_bytes(os.urandom(_TICKET), "little")  # of the last message
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        _open_pools.add(self)

    def is_near(self, name: str) -> bool:
        """Whether a session can read this file."""
        return (self._folder / name).exists()

    def lend(self, data: bytes, borrowers: int) -> Loan | None:
        """Write a message for this number of borrowers; returns None if it has no room."""
        with self._lock:
            ticket = self._next_ticket()
            head = ticket + bytes(borrowers)
            lent = self._reserve(len(head) + len(data), borrowers)
            if lent is None:
                return None
            memory = self._memory
            if memory is None or lent.end > len(memory):
                memory = self._grown(lent.end)
            if memory is None:
                self._lent.remove(lent)
                return None
            begin = lent.offset + len(head)
            memory[lent.offset : begin] = head
            memory[begin : begin + len(data)] = data
        return Loan(ticket, lent.offset, len(data), borrowers)

    def _next_ticket(self) -> bytes:
        self._ticket = (self._ticket + 1) % _TICKETS
        return self._ticket.to_bytes(_TICKET, "little")

    def bury(self, name: str) -> None:
        """Remove the file of a session whose process was killed."""
        path = self._folder / name
        with suppress(OSError):
            file = os.open(path, _EXISTING)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails while the process lives
                path.unlink()
            finally:
                os.close(file)

    def close(self) -> None:
        """Remove the file, once what is lent has been read, or a moment later."""
        end = time.monotonic() + _PATIENCE
        while self._is_awaited() and time.monotonic() < end:
            time.sleep(_BETWEEN_LOOKS)
        with self._lock:
            self._limit = 0
            self._lent.clear()
            with suppress(OSError):
                (self._folder / self._name).unlink()
            self.abandon()

    def abandon(self) -> None:
        """Close this process's copy of the file, after a fork: the lock is gone with the last one."""
        memory, self._memory = self._memory, None
        file, self._file = self._file, -1
        if memory is not None:
            memory.close()
        if file >= 0:
            os.close(file)

    def _is_awaited(self) -> bool:
        with self._lock:
            self._take_back()
            return bool(self._lent)

    def _reserve(self, size: int, borrowers: int) -> _Lent | None:
        """Find the first gap that is large enough."""
        self._take_back()
        size = _rounded(size, _PAGE)
        position = offset = 0
        for lent in self._lent:
            if lent.offset - offset >= size:
                break
            position, offset = position + 1, lent.end
        if offset + size > self._limit or len(self._lent) >= _MOST_LOANS:
            return None
        found = _Lent(offset, offset + size, borrowers, time.monotonic() + _LONGEST)
        self._lent.insert(position, found)
        return found

    def _take_back(self) -> None:
        if self._lent:
            now = time.monotonic()
            self._lent = [each for each in self._lent if now < each.until and not self._is_read(each)]

    def _is_read(self, lent: _Lent) -> bool:
        # By the system, as borrowers write it: what they had to read before is read.
        return 0 not in os.pread(self._file, lent.borrowers, lent.offset + _TICKET)

    def _grown(self, size: int) -> mmap.mmap | None:
        """Let the file grow, and reserve all of it: to write where there is no memory would be fatal."""
        size = min(_rounded(size, _STEP), self._limit)
        try:
            os.posix_fallocate(self._file, 0, size)
            self._memory = mmap.mmap(self._file, size)
        except OSError:
            say(f"{SHARED} is full: large messages to other processes go over sockets, which is slower")
            self._limit = 0 if self._memory is None else len(self._memory)
            return None
        return self._memory


class Borrower:
    """Reads what other sessions lend to this one. Their files stay mapped until they are gone."""

    def __init__(self) -> None:
        self._folder = own_folder(SHARED)
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._known: dict[str, tuple[int, mmap.mmap]] = {}

    def read(self, owner: str, loan: Loan, place: int) -> bytes | None:
        """Copy a message, as the borrower with this number; None if it is not there any more."""
        with self._lock:
            try:
                file, memory = self._mapped(owner, loan)
                begin = loan.begin
                found = memory[loan.offset : loan.offset + _TICKET] == loan.ticket
                data = memory[begin : begin + loan.length] if found else b""
                if memory[loan.offset : loan.offset + _TICKET] != loan.ticket or len(data) != loan.length:
                    return None
                os.pwrite(file, b"\1", loan.offset + _TICKET + place)
            except (OSError, ValueError):
                return None
        return data

    def forget(self, owner: str) -> None:
        """Let go of the file of a session that is gone."""
        with self._lock:
            known = self._known.pop(owner, None)
            if known is not None:
                os.close(known[0])  # the mapping goes with its last reference

    def close(self) -> None:
        """Let go of everything."""
        for owner in list(self._known):
            self.forget(owner)

    def _mapped(self, owner: str, loan: Loan) -> tuple[int, mmap.mmap]:
        """The file, as far as it has grown meanwhile."""
        known = self._known.get(owner)
        if known is None:
            known = self._known[owner] = _map(os.open(self._folder / owner, _EXISTING))
        elif loan.begin + loan.length > len(known[1]):
            known = self._known[owner] = known[0], mmap.mmap(known[0], 0)
        return known


def _map(file: int) -> tuple[int, mmap.mmap]:
    try:
        return file, mmap.mmap(file, 0)
    except (OSError, ValueError):  # empty
        os.close(file)
        raise


def _rounded(size: int, step: int) -> int:
    return -(-size // step) * step


def _locked_file(path: Path) -> int:
    """Make a file and lock it; whoever looks for what killed processes left may have been faster."""
    for _ in range(_MOST_TRIES):
        file = os.open(path, _EXISTING | os.O_CREAT, 0o600)
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.fstat(file).st_nlink:
                return file
        os.close(file)
    raise TransportError(f"{path} cannot be locked")


def _abandon_all() -> None:
    for pool in list(_open_pools):
        pool.abandon()


_open_pools: weakref.WeakSet[Pool] = weakref.WeakSet()
if IS_POSSIBLE:
    os.register_at_fork(after_in_child=_abandon_all)
