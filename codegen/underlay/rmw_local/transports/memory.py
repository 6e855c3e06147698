"""Large messages between processes of one user on one machine, through a file in memory.

Each session has such a file. It writes a message there once, and lends it to any number of other processes.
These read it and note that beside it.

A file begins with a table. Each line of it has a ticket that nobody can guess, and says what is lent: where
it is, how long it is, under which key, and for how many. A borrower is told the ticket and the line, and
believes the table for the rest, which only processes of this user on this machine can write. A ticket that is
not there, before and after reading, means that the place was lent again. Before the message, each borrower
has a byte, which it sets to one. It gets a message once.
"""

from __future__ import annotations

import _thread
import errno
import mmap
import os
import stat
import struct
import sys
import time
import weakref
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from rmw_local.notices import say
from rmw_local.transports import TransportError
from rmw_local.transports.doorbell import own_folder, own_name

if sys.platform != "win32":
    import fcntl

IS_POSSIBLE: Final = sys.platform == "linux"
"""Whether the system has a folder for files in memory."""

SHARED: Final = Path("/dev/shm")
"""That folder."""

TICKET: Final = 16
"""Bytes of a ticket."""

_LINE: Final = struct.Struct("<16sQQHHH")  # ticket, offset, length, borrowers, lengths of key and attachment
_NO_LINE: Final = bytes(_LINE.size)
_NO_TICKET: Final = bytes(TICKET)
_PAGE: Final = 4096  # bytes
_MOST_LOANS: Final = 256
_TABLE: Final = -(-_MOST_LOANS * _LINE.size // _PAGE) * _PAGE  # bytes
_STEP: Final = 1024 * 1024  # bytes that a file grows by
_EXISTING: Final = os.O_RDWR | os.O_CLOEXEC | getattr(os, "O_NOFOLLOW", 0)
# A connection is lost after ten seconds without a sign of life, and what was on its way with it.
_LONGEST: Final = 20.0  # [s] that a borrower may take
_PATIENCE: Final = 0.5  # [s] for borrowers, at the end
_BETWEEN_LOOKS: Final = 0.001  # [s]
_MOST_TRIES: Final = 3


class Loan(NamedTuple):
    """A message in somebody's file: its ticket, and the line of the table that has it."""

    ticket: bytes
    line: int


@dataclass(slots=True, eq=False)
class _Lent:
    """The pages of a message, until all borrowers have read it, or should have (monotonic [s])."""

    line: int
    offset: int
    end: int
    borrowers: int
    until: float


class Pool:
    """The file of one session, of at most `size` bytes. Where there can be none, one line says why.

    `name` is the session's. While its file is there and locked, others may lend to it.
    """

    def __init__(self, name: str, size: int) -> None:
        self._folder = SHARED / own_name()
        self._path = str(self._folder / name)  # a Path would take 10 us of each message
        self._size = self._limit = size
        self._file = -1
        self._status: os.stat_result | None = None  # of the file, when it was made
        self._is_closed = self._has_said = False
        self._memory: mmap.mmap | None = None  # of the whole file, once there is something in it
        self._lent: list[_Lent] = []  # by offset
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        _open_pools.add(self)
        with suppress(OSError):
            for each in self._folder.iterdir():
                self.remove_orphan(each.name)
        self.keep()

    def can_read(self, name: str) -> bool:
        """Whether a session can read this file."""
        try:
            return stat.S_ISREG((self._folder / name).lstat().st_mode)
        except OSError:
            return False

    def keep(self) -> None:
        """Make the file again if it was deleted: at logout, systemd does that while programs run on."""
        with self._lock:
            self._has_file()

    def lend(self, data: bytes, borrowers: int, key: bytes = b"", attachment: bytes = b"") -> Loan | None:
        """Write a message for this number of borrowers; returns None if it has no room."""
        head = bytes(borrowers) + key + attachment
        with self._lock:
            lent = self._reserve(len(head) + len(data), borrowers) if self._has_file() else None
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
            ticket = os.urandom(TICKET)
            line = _LINE.pack(ticket, lent.offset, len(data), borrowers, len(key), len(attachment))
            _write(memory, lent.line, line)
        return Loan(ticket, lent.line)

    def remove_orphan(self, name: str) -> None:
        """Remove the file of a session whose process was killed."""
        _remove_orphan(self._folder / name)

    def close(self) -> None:
        """Remove the file, once what is lent has been read, or a moment later."""
        end = time.monotonic() + _PATIENCE
        while self._is_awaited() and time.monotonic() < end:
            time.sleep(_BETWEEN_LOOKS)
        with self._lock:
            self._is_closed = True
            if self._is_there():
                with suppress(OSError):
                    Path(self._path).unlink()
            self._let_go()

    def forget(self) -> None:
        """Close this process's copy of the file, after a fork: the lock is gone with the last one."""
        self._is_closed = True
        self._let_go()

    def _let_go(self) -> None:
        self._lent.clear()
        self._status = None
        memory, self._memory = self._memory, None
        file, self._file = self._file, -1
        if memory is not None:
            memory.close()
        if file >= 0:
            os.close(file)

    def _has_file(self) -> bool:
        """Whether there is a file that others can open; makes one if there is none."""
        if self._is_closed or self._is_there():
            return not self._is_closed
        try:
            path = own_folder(SHARED) / Path(self._path).name
            if _is_at(path, self._file):
                path.unlink()  # somebody has cut it
            file = _locked_file(path)
        except (TransportError, OSError) as error:
            self._say_why_not(error)
            return False
        self._let_go()  # of the old one: those who have opened it keep what they were lent
        self._file, self._limit, self._status = file, self._size, os.fstat(file)
        return True

    def _is_there(self) -> bool:
        """Whether others can open the file, and it is as long as it was: to use more would be fatal."""
        if self._status is None:
            return False
        try:
            found = os.lstat(self._path)
        except OSError:
            return False
        length = 0 if self._memory is None else len(self._memory)
        return os.path.samestat(found, self._status) and found.st_size >= length

    def _is_awaited(self) -> bool:
        with self._lock:
            if not self._is_there():
                return False
            self._take_back()
            return bool(self._lent)

    def _reserve(self, size: int, borrowers: int) -> _Lent | None:
        """Find the first gap that is large enough."""
        self._take_back()
        size = _rounded(size, _PAGE)
        position, offset = 0, _TABLE
        for lent in self._lent:
            if lent.offset - offset >= size:
                break
            position, offset = position + 1, lent.end
        if offset + size > self._limit or len(self._lent) >= _MOST_LOANS:
            return None
        taken = {each.line for each in self._lent}
        line = next(number for number in range(_MOST_LOANS) if number not in taken)
        found = _Lent(line, offset, offset + size, borrowers, time.monotonic() + _LONGEST)
        self._lent.insert(position, found)
        return found

    def _take_back(self) -> None:
        if not self._lent or self._memory is None:
            return
        now = time.monotonic()
        kept: list[_Lent] = []
        for each in self._lent:
            if now < each.until and not self._is_read(each):
                kept.append(each)
            else:  # before its pages are used again
                _write(self._memory, each.line, _NO_LINE)
        self._lent = kept

    def _is_read(self, lent: _Lent) -> bool:
        # By the system, as borrowers write it: what they had to read before is read.
        return 0 not in os.pread(self._file, lent.borrowers, lent.offset)

    def _grown(self, size: int) -> mmap.mmap | None:
        """Let the file grow, and reserve all of it: to write where there is no memory would be fatal."""
        size = min(_rounded(size, _STEP), self._limit)
        try:
            os.posix_fallocate(self._file, 0, size)
            self._memory = mmap.mmap(self._file, size)
        except OSError as error:
            self._say_why_not(error)
            self._limit = 0 if self._memory is None else len(self._memory)
            return None
        return self._memory

    def _say_why_not(self, error: Exception) -> None:
        if self._has_said:
            return
        self._has_said = True
        is_full = isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT}
        why = f"{SHARED} is full" if is_full else str(error)
        say(f"{why}: large messages to other processes go over sockets, which is slower")


@dataclass(slots=True)
class _File:
    """The file of another session."""

    number: int
    memory: mmap.mmap

    def has(self, end: int) -> bool:
        """Whether it is as long as that [bytes] now; it may have grown."""
        size = os.fstat(self.number).st_size
        if len(self.memory) < end <= size:
            self.memory = _mapped(self.number)
        return end <= size


class Borrower:
    """Reads what other sessions lend to this one. Their files stay mapped until they are gone."""

    def __init__(self) -> None:
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._known: dict[str, _File] = {}

    def read(self, owner: str, loan: Loan, place: int, key: bytes = b"") -> tuple[bytes, bytes] | None:
        """Copy the attachment and the message that are lent under a key, as the borrower with this number.

        None if they are not there any more, or never were.
        """
        if loan.ticket == _NO_TICKET or not 0 <= loan.line < _MOST_LOANS:
            return None
        with self._lock:
            try:
                return self._read(self._file_of(owner, loan), loan, place, key)
            except (OSError, ValueError, TransportError):
                return None

    def forget(self, owner: str) -> None:
        """Let go of the file of a session that is gone."""
        with self._lock:
            known = self._known.pop(owner, None)
            if known is not None:
                os.close(known.number)  # the mapping goes with its last reference

    def close(self) -> None:
        """Let go of everything."""
        for owner in list(self._known):
            self.forget(owner)

    def _file_of(self, owner: str, loan: Loan) -> _File:
        """The file with this ticket: the one that is known, or the one that has taken its place."""
        known = self._known.get(owner)
        if known is not None:
            if known.has(_TABLE) and _ticket(known.memory, loan.line) == loan.ticket:
                return known
            if _is_at(SHARED / own_name() / owner, known.number):
                return known
            os.close(self._known.pop(owner).number)
        known = self._known[owner] = _opened(owner)
        return known

    @staticmethod
    def _read(file: _File, loan: Loan, place: int, key: bytes) -> tuple[bytes, bytes] | None:
        if not file.has(_TABLE):
            return None
        ticket, offset, length, borrowers, *heads = _LINE.unpack_from(file.memory, loan.line * _LINE.size)
        begin = offset + borrowers + sum(heads)
        if ticket != loan.ticket or place >= borrowers or not file.has(begin + length):
            return None
        memory, about = file.memory, offset + borrowers
        if memory[about : about + heads[0]] != key or memory[offset + place]:
            return None
        found = memory[about + heads[0] : begin], memory[begin : begin + length]
        if _ticket(memory, loan.line) != ticket:
            return None
        os.pwrite(file.number, b"\1", offset + place)
        return found


def _write(memory: mmap.mmap, number: int, line: bytes) -> None:
    memory[number * _LINE.size : (number + 1) * _LINE.size] = line


def _ticket(memory: mmap.mmap, line: int) -> bytes:
    return memory[line * _LINE.size : line * _LINE.size + TICKET]


def _opened(owner: str) -> _File:
    """Open the file of a session, if it is this user's; raises OSError, ValueError or TransportError."""
    file = os.open(own_folder(SHARED) / owner, _EXISTING | os.O_NONBLOCK)
    try:
        status = os.fstat(file)
        if not stat.S_ISREG(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
            raise ValueError(f"{owner} is not a file that only its owner can use")
        return _File(file, _mapped(file))
    except (OSError, ValueError):  # empty, for one
        os.close(file)
        raise


def _is_at(path: Path, file: int) -> bool:
    """Whether this open file, -1 for none, is still the one with this path."""
    try:
        return os.path.samestat(path.lstat(), os.fstat(file))
    except OSError:
        return False


def _mapped(file: int) -> mmap.mmap:
    return mmap.mmap(file, 0, prot=mmap.PROT_READ)


def _rounded(size: int, step: int) -> int:
    return -(-size // step) * step


def _locked_file(path: Path) -> int:
    """Make a file and lock it; whoever looks for what killed processes left may have been faster."""
    for _ in range(_MOST_TRIES):
        try:
            file = os.open(path, _EXISTING | os.O_CREAT | os.O_EXCL, 0o600)
        except FileExistsError:
            _remove_orphan(path)
            continue
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.fstat(file).st_nlink:
                return file
        os.close(file)
    raise TransportError(f"{path} cannot be locked")


def _remove_orphan(path: Path) -> None:
    """Remove a file that no process has locked."""
    with suppress(OSError):
        file = os.open(path, _EXISTING | os.O_NONBLOCK)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails while the process lives
            path.unlink()
        finally:
            os.close(file)


def _abandon_all() -> None:
    for pool in list(_open_pools):
        pool.forget()


_open_pools: weakref.WeakSet[Pool] = weakref.WeakSet()
if IS_POSSIBLE:
    os.register_at_fork(after_in_child=_abandon_all)
