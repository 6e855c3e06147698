"""The short way of large messages, to processes that can read this one's file in memory.

Such a process gets a notice, on a key of its own below the topic's: `<data key>/ifgen_memory/<to>/<from>`,
with the ids of the two sessions. It has the ticket of the message, and says for which subscriptions it is. If
anybody in the audience is farther away, the message goes to all on the topic's key.

Only private sessions lend and borrow, as for requests (`calls`): the access control of routers knows the keys
of topics, and no others. A notice itself proves nothing: its ticket does, and the key in the file.
"""

from __future__ import annotations

import _thread
import struct
from typing import TYPE_CHECKING, Final

import zenoh
from zenoh import CongestionControl, Locality

from rmw_local.notices import Repeated
from rmw_local.transports.environment import read_memory
from rmw_local.transports.memory import IS_POSSIBLE, TICKET, Borrower, Loan, Pool
from rmw_local.transports.zenoh import attachments, tokens

if TYPE_CHECKING:
    from rmw_local.transports.background import Background
    from rmw_local.transports.interface import Audience, OnSample
    from rmw_local.transports.zenoh.presence import Gate

_PART: Final = "ifgen_memory"
_DYING: Final = 0.2  # [s] from the end of a killed process's connection to that of its locks
_NOTICE: Final = struct.Struct(f"<{TICKET}sHH")  # ticket, line, which of the borrowers
_MOST_GIDS: Final = 4096  # of the subscriptions in one process
_LONGEST_NOTICE: Final = _NOTICE.size + _MOST_GIDS * attachments.GID  # bytes


class SharedMemory:
    """The shared memory of one session, if it is private."""

    def __init__(
        self,
        session: zenoh.Session,
        gate: Gate,
        background: Background,
        domain: int,
        malformed: Repeated,
        *,
        is_private: bool,
    ) -> None:
        self._session = session
        self._id = str(session.zid())
        self._malformed = malformed
        self._background = background
        self._listening: dict[bytes, tuple[str, OnSample]] = {}  # the topic's key and what to call, by gid
        self._pool: Pool | None = None
        self._borrower = Borrower()
        self._readers: set[str] = set()
        self._gone: set[str] = set()  # or perhaps only a node of theirs is
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        size, self.threshold = read_memory()
        if is_private and size and IS_POSSIBLE:
            self._pool = Pool(self._id, size)
            self._declared = session.declare_subscriber(
                f"{domain}/**/{_PART}/{self._id}/*",
                gate.callback(self._on_notice),
                allowed_origin=Locality.REMOTE,
            )

    def listen(self, gid: bytes, key: str, on_sample: OnSample) -> Listening:
        """Receive what is lent to a subscription of the topic with this key."""
        self._listening[gid] = key, on_sample
        return Listening(self._listening, gid)

    def lend(
        self, key: str, audience: Audience, congestion: CongestionControl, data: bytes, attachment: bytes
    ) -> bool:
        """Lend a message to all who are to get it; False if that is not possible."""
        pool = self._pool
        if pool is None:
            return False
        borrowers: dict[str, list[bytes]] = {}
        for peer, gid in audience():
            borrowers.setdefault(peer, []).append(gid)
        if not borrowers or not all(self._can_read(pool, peer) for peer in borrowers):
            return False
        if max(map(len, borrowers.values())) > _MOST_GIDS:
            return False
        loan = pool.lend(data, len(borrowers), key.encode(), attachment)
        if loan is None:
            return False
        for place, (peer, gids) in enumerate(borrowers.items()):
            self._session.put(
                f"{key}/{_PART}/{peer}/{self._id}",
                pack(loan, place, gids),
                congestion_control=congestion,
                allowed_destination=Locality.REMOTE,
            )
        return True

    def _can_read(self, pool: Pool, session: str) -> bool:
        if session in self._readers:
            return True
        if pool.can_read(session):  # its file is there before others see anything of a session
            self._readers.add(session)
            return True
        return False

    def keep(self) -> None:
        """See to it that others find this session's file: a message has come over a socket that is large."""
        if self._pool is not None:
            self._pool.keep()

    def release(self, session: str) -> None:
        """Let go of the memory of a session, if it is gone, and remove it if its process was killed."""
        if self._pool is None:
            return
        with self._lock:
            is_first = not self._gone
            self._gone.add(session)
        if is_first:
            self._background.start(self._release_all, self._pool, delay=_DYING)

    def _release_all(self, pool: Pool) -> None:
        with self._lock:
            gone, self._gone = self._gone, set()
        for session in gone:
            pool.remove_orphan(session)
            if not pool.can_read(session):
                self._borrower.forget(session)
                self._readers.discard(session)

    def finish(self) -> None:
        """Lend no more, and let others read what they were lent."""
        if self._pool is not None:
            self._pool.close()

    def close(self) -> None:
        """Let go of what others lend. The session is closed."""
        self._borrower.close()

    def _on_notice(self, sample: zenoh.Sample) -> None:
        name, payload = str(sample.key_expr), sample.payload
        key = name.rpartition(f"/{_PART}/")[0]
        try:
            owner = tokens.session_id(name.rpartition("/")[2])
            if len(payload) > _LONGEST_NOTICE:
                raise ValueError(f"a notice about shared memory has {len(payload)} bytes")
            loan, place, gids = unpack(payload.to_bytes())
            found = self._borrower.read(owner, loan, place, key.encode())
            if found is None:
                raise ValueError("it is not in shared memory any more")
            known, data = attachments.unpack(found[0]), found[1]
        except ValueError as error:
            self._malformed.add(str(error))
            return
        for gid in dict.fromkeys(gids):
            own_key, on_sample = self._listening.get(gid, ("", None))
            if on_sample is None:  # gone meanwhile
                continue
            if own_key == key:
                on_sample(data, *known)
            else:
                self._malformed.add("a notice about shared memory is for a subscription of another topic")


class Listening:
    """A subscription that receives what is lent to it."""

    def __init__(self, listening: dict[bytes, tuple[str, OnSample]], gid: bytes) -> None:
        self._listening, self._gid = listening, gid

    def undeclare(self) -> None:
        """Receive no longer."""
        self._listening.pop(self._gid, None)


def pack(loan: Loan, place: int, gids: list[bytes]) -> bytes:
    """A notice to the borrower with this number, for subscriptions with these gids."""
    return _NOTICE.pack(*loan, place) + b"".join(gids)


def unpack(notice: bytes) -> tuple[Loan, int, list[bytes]]:
    """Read a notice; raises ValueError."""
    size = attachments.GID
    if len(notice) < _NOTICE.size or (len(notice) - _NOTICE.size) % size:
        raise ValueError(f"a notice about shared memory has {len(notice)} bytes")
    ticket, line, place = _NOTICE.unpack_from(notice)
    gids = [notice[begin : begin + size] for begin in range(_NOTICE.size, len(notice), size)]
    return Loan(ticket, line), place, gids
