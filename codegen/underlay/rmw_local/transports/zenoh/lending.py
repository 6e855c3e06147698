"""The short way of large messages, to processes that can read this one's file in memory.

Such a process gets a notice, on a key of its own below the topic's: `<data key>/ifgen_memory/<to>/<from>`,
with the ids of the two sessions. It tells where the message is, and for which subscriptions. The attachment
is the message's. If anybody in the audience is farther away, the message goes to all on the topic's key.
"""

from __future__ import annotations

import _thread
import struct
from typing import TYPE_CHECKING, Final

import zenoh
from zenoh import CongestionControl, Locality

from rmw_local.notices import Repeated, say
from rmw_local.transports.environment import read_memory
from rmw_local.transports.errors import TransportError
from rmw_local.transports.memory import IS_POSSIBLE, Borrower, Loan, Pool
from rmw_local.transports.zenoh import attachments, tokens

if TYPE_CHECKING:
    from rmw_local.transports.background import Background
    from rmw_local.transports.seam import Audience, OnSample
    from rmw_local.transports.zenoh.presence import Gate

_PART: Final = "ifgen_memory"
_DYING: Final = 0.2  # [s] from the end of a killed process's connection to that of its locks
_NOTICE: Final = struct.Struct("<8sQQHH")  # ticket, offset, length, borrowers, which of them


class Lending:
    """The shared memory of one session."""

    def __init__(
        self, session: zenoh.Session, gate: Gate, background: Background, domain: int, malformed: Repeated
    ) -> None:
        self._session = session
        self._id = str(session.zid())
        self._malformed = malformed
        self._background = background
        self._listening: dict[bytes, OnSample] = {}  # by gid
        self._pool: Pool | None = None
        self._near: dict[str, bool] = {}
        self._gone: set[str] = set()  # or perhaps only a node of theirs is
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._size, self.threshold = read_memory()
        if self._open():
            self._declared = session.declare_subscriber(
                f"{domain}/**/{_PART}/{self._id}/*",
                gate.callback(self._on_notice),
                allowed_origin=Locality.REMOTE,
            )

    def listen(self, gid: bytes, on_sample: OnSample) -> Listening:
        """Receive what is lent to a subscription."""
        self._listening[gid] = on_sample
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
        if not borrowers or not all(map(self._is_near, borrowers)):
            return False
        loan = pool.lend(data, len(borrowers))
        if loan is None:
            return False
        for place, (peer, gids) in enumerate(borrowers.items()):
            self._session.put(
                f"{key}/{_PART}/{peer}/{self._id}",
                pack(loan, place, gids),
                attachment=attachment,
                congestion_control=congestion,
                allowed_destination=Locality.REMOTE,
            )
        return True

    def _is_near(self, session: str) -> bool:
        near = self._near.get(session)
        if near is None:  # it is decided before others see anything of a session
            near = self._near[session] = self._pool is not None and self._pool.is_near(session)
        return near

    def bury(self, session: str) -> None:
        """Let go of the memory of a session, if it is gone, and remove it if its process was killed."""
        if self._pool is None:
            return
        with self._lock:
            is_first = not self._gone
            self._gone.add(session)
        if is_first:
            self._background.start(self._bury_all, self._pool, delay=_DYING)

    def _bury_all(self, pool: Pool) -> None:
        with self._lock:
            gone, self._gone = self._gone, set()
        for session in gone:
            pool.bury(session)
            if not pool.is_near(session):
                self._borrower.forget(session)
                self._near.pop(session, None)

    def finish(self) -> None:
        """Lend no more, and let others read what they were lent."""
        if self._pool is not None:
            self._pool.close()

    def close(self) -> None:
        """Let go of what others lend. The session is closed."""
        if self._pool is not None:
            self._borrower.close()

    def _open(self) -> bool:
        if not self._size or not IS_POSSIBLE:
            return False
        try:
            self._pool, self._borrower = Pool(self._id, self._size), Borrower()
        except (TransportError, OSError) as error:
            say(f"large messages to other processes go over sockets, which is slower: {error}")
            return False
        return True

    def _on_notice(self, sample: zenoh.Sample) -> None:
        try:
            owner = tokens.session_id(str(sample.key_expr).rpartition("/")[2])
            loan, place, gids = unpack(sample.payload.to_bytes())
            attached = sample.attachment
            known = attachments.unpack(b"" if attached is None else attached.to_bytes())
        except ValueError as error:
            self._malformed.add(str(error))
            return
        data = self._borrower.read(owner, loan, place)
        if data is None:
            self._malformed.add("it is not in shared memory any more")
            return
        for gid in gids:
            on_sample = self._listening.get(gid)
            if on_sample is not None:
                on_sample(data, *known)


class Listening:
    """A subscription that receives what is lent to it."""

    def __init__(self, listening: dict[bytes, OnSample], gid: bytes) -> None:
        self._listening, self._gid = listening, gid

    def undeclare(self) -> None:
        """Receive no longer."""
        self._listening.pop(self._gid, None)


def pack(loan: Loan, place: int, gids: list[bytes]) -> bytes:
    """A notice to the borrower with this number, for subscriptions with these gids."""
    return _NOTICE.pack(loan.ticket, loan.offset, loan.length, loan.borrowers, place) + b"".join(gids)


def unpack(notice: bytes) -> tuple[Loan, int, list[bytes]]:
    """Read a notice; raises ValueError."""
    size = attachments.GID
    if len(notice) < _NOTICE.size or (len(notice) - _NOTICE.size) % size:
        raise ValueError(f"a notice about shared memory has {len(notice)} bytes")
    ticket, offset, length, borrowers, place = _NOTICE.unpack_from(notice)
    if place >= borrowers:
        raise ValueError(f"a notice is for borrower {place} of {borrowers}")
    gids = [notice[begin : begin + size] for begin in range(_NOTICE.size, len(notice), size)]
    return Loan(ticket, offset, length, borrowers), place, gids
