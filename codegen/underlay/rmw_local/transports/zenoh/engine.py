"""The transport: one Zenoh session, with a token for each entity.

Callbacks run on Zenoh's own threads (`indirect=False`): a thread of Python for them would keep the
interpreter from ending. They queue and wake, nothing else.
"""

from __future__ import annotations

import _thread
import secrets
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

import zenoh
from zenoh import CongestionControl, ConsolidationMode, Locality, QueryTarget, Reliability, SampleKind
from zenoh.ext import (
    CacheConfig,
    HistoryConfig,
    MissDetectionConfig,
    RecoveryConfig,
    declare_advanced_publisher,
    declare_advanced_subscriber,
)
from zenoh.handlers import Callback, FifoChannel

from rmw_local.notices import Repeated
from rmw_local.qos import KEEP_ALL, RELIABLE, TRANSIENT_LOCAL, QosProfile
from rmw_local.transports.errors import TransportError
from rmw_local.transports.seam import Entity, OnEntity, OnReply, OnRequest, OnSample
from rmw_local.transports.zenoh import attachments, tokens
from rmw_local.transports.zenoh.keys import alive_key, data_key

_KEPT_OF_ALL: Final = 10_000
"""The number of messages that are kept for late joiners where the history is "keep all"."""
_MOST_REQUESTS: Final = 10_000
"""The number of requests of one service that may wait for their responses."""
_MOST_ANSWERS: Final = 256
"""The number of answers to an inquiry that wait: more would hold up Zenoh until somebody looks."""
_TO_SERVERS: Final[dict[str, Any]] = {
    "target": QueryTarget.ALL_COMPLETE,
    "consolidation": ConsolidationMode.NONE,
    "allowed_destination": Locality.REMOTE,
}
_HEARTBEAT: Final = 0.5  # [s], of transient local publishers
_RESULT_SERVICE: Final = "/_action/get_result"
_MOST_TRIES: Final = 500
_BETWEEN_TRIES: Final = 0.001  # [s]
_NO_END: Final = 100 * 365 * 86_400.0  # [s]


class ZenohTransport:
    """A `rmw_local.transports.seam.Transport`. The configuration is made when the session opens."""

    def __init__(self, domain: int, configuration: Callable[[], zenoh.Config]) -> None:
        self.malformed = Repeated("dropped {count} malformed message{s} from another process: {why}")
        self._domain = domain
        self._configuration = configuration

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        """Open the session and follow the graph."""
        try:
            self._session = zenoh.open(self._configuration())
        except zenoh.ZError as error:
            reason = str(error).partition(" at /")[0]  # without the place in Zenoh's sources
            raise TransportError(f"Zenoh says: {reason.strip()}") from None
        self._id = str(self._session.zid())
        self._liveliness = self._session.liveliness()
        self._followed = [
            self._liveliness.declare_subscriber(
                tokens.pattern(self._domain),
                Callback(partial(self._on_token, on_entity), indirect=False),
                history=True,
            ),
            self._session.declare_subscriber(
                alive_key(self._domain, "*"),
                Callback(partial(self._on_alive, on_alive), indirect=False),
                allowed_origin=Locality.REMOTE,
            ),
        ]

    def close(self) -> None:
        """Close the session."""
        self._session.close()  # type: ignore[no-untyped-call]  # its stub has no return type

    def knows_router(self) -> bool:
        """Whether a router is connected."""
        return bool(self._session.info.routers_zid())

    def announce(self, node: Entity) -> _Presence:
        """Declare a node's token."""
        return _Presence(*self._token(node))

    def publish(self, publisher: Entity) -> _Publication:
        """Declare a publisher, for a transient local one also what keeps its messages."""
        qos, key = publisher.qos, self._key(publisher)
        options: dict[str, Any] = {
            "reliability": Reliability.RELIABLE if qos.reliability == RELIABLE else Reliability.BEST_EFFORT,
            "congestion_control": CongestionControl.BLOCK if _blocks(qos) else CongestionControl.DROP,
            "allowed_destination": Locality.REMOTE,
        }
        if qos.durability == TRANSIENT_LOCAL:
            if qos.reliability == RELIABLE:
                options["sample_miss_detection"] = MissDetectionConfig(
                    heartbeat=None, sporadic_heartbeat=_HEARTBEAT
                )
            declared: Any = declare_advanced_publisher(
                self._session, key, cache=CacheConfig(_history(qos)), publisher_detection=True, **options
            )
        else:
            declared = self._session.declare_publisher(key, **options)
        token, gid = self._token(publisher)
        return _Publication(token, gid, declared, partial(self._say_alive, gid))

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> _Presence:
        """Declare a subscriber, for a transient local one also what asks for earlier messages."""
        qos, key = subscription.qos, self._key(subscription)
        handler = Callback(partial(self._on_sample, on_sample), indirect=False)
        declared: Any
        if qos.durability == TRANSIENT_LOCAL:
            reliable = qos.reliability == RELIABLE
            declared = declare_advanced_subscriber(
                self._session,
                key,
                handler,
                allowed_origin=Locality.REMOTE,
                history=HistoryConfig(detect_late_publishers=True, max_samples=_history(qos)),
                recovery=RecoveryConfig(periodic_queries=None, heartbeat=True) if reliable else None,
                subscriber_detection=True,
            )
        else:
            declared = self._session.declare_subscriber(key, handler, allowed_origin=Locality.REMOTE)
        return _Presence(*self._token(subscription), declared)

    def ask(self, client: Entity, on_reply: OnReply) -> _Asking:
        """Declare a client's token."""
        token, gid = self._token(client)
        endless = client.name.endswith(_RESULT_SERVICE)
        handler = partial(self._on_reply, on_reply, gid)
        return _Asking(token, gid, self._session, self._key(client), handler, _NO_END if endless else None)

    def inquire(self, server: Entity, data: bytes, patience: float) -> Callable[[], Iterable[bytes]]:
        """Send a query under a gid that nobody else has seen."""
        gid = secrets.token_bytes(attachments.GID)
        attachment = attachments.pack(1, time.time_ns(), gid)
        # A channel has no code of Python. A callback that Zenoh's threads drop while Python ends is fatal.
        channel: Any = FifoChannel(_MOST_ANSWERS)
        key = self._key(server)
        try:
            replies = self._session.get(
                key, channel, payload=data, attachment=attachment, timeout=patience, **_TO_SERVERS
            )
        except zenoh.ZError:  # closed meanwhile
            return tuple
        return partial(self._answers, replies, gid)

    def serve(self, server: Entity, on_request: OnRequest) -> _Serving:
        """Declare a queryable."""
        serving = _Serving(self._key(server))
        handler = Callback(partial(self._on_request, on_request, serving), indirect=False)
        declared = self._session.declare_queryable(
            self._key(server), handler, complete=True, allowed_origin=Locality.REMOTE
        )
        serving.follow(*self._token(server), declared)
        return serving

    def _key(self, endpoint: Entity) -> str:
        return data_key(self._domain, endpoint.name, endpoint.type_name, endpoint.type_hash)

    def _token(self, entity: Entity) -> tuple[zenoh.LivelinessToken, bytes]:
        """Declare a token, after what it tells of; returns it with the gid."""
        text = tokens.write(self._domain, self._id, entity)
        return self._liveliness.declare_token(text), tokens.gid_of(text)

    def _say_alive(self, gid: bytes) -> None:
        _quietly(lambda: self._session.put(alive_key(self._domain, gid.hex()), b""))

    # Callbacks, on Zenoh's threads

    def _on_token(self, on_entity: OnEntity, sample: zenoh.Sample) -> None:
        text = str(sample.key_expr)
        if tokens.session_of(text) == self._id:
            return
        try:
            entity = tokens.read(text)
        except ValueError as error:
            self.malformed.add(str(error))
            return
        on_entity(entity, sample.kind == SampleKind.PUT)

    def _on_alive(self, on_alive: Callable[[bytes], None], sample: zenoh.Sample) -> None:
        digits = str(sample.key_expr).rpartition("/")[2]
        try:
            on_alive(bytes.fromhex(digits))
        except ValueError as error:
            self.malformed.add(str(error))

    def _on_sample(self, on_sample: OnSample, sample: zenoh.Sample) -> None:
        if sample.kind != SampleKind.PUT:
            return
        attached = sample.attachment
        if attached is None:  # some tools send without
            on_sample(sample.payload.to_bytes(), 0, time.time_ns(), b"")
            return
        known = self._unpacked(attached)
        if known is not None:
            on_sample(sample.payload.to_bytes(), *known)

    def _on_request(self, on_request: OnRequest, serving: _Serving, query: zenoh.Query) -> None:
        known = self._unpacked(query.attachment)
        payload = query.payload
        if known is None or payload is None:
            return
        number, stamp, client = known
        if serving.keep(query, client, number):
            on_request(payload.to_bytes(), number, stamp, client)
        else:
            self.malformed.add("a request came twice, or too many wait for their responses")

    def _on_reply(self, on_reply: OnReply, gid: bytes, reply: zenoh.Reply) -> None:
        sample = reply.ok
        if sample is None:
            return
        known = self._unpacked(sample.attachment)
        if known is not None and known.gid == gid:
            on_reply(sample.payload.to_bytes(), known.number, known.stamp)

    def _answers(self, replies: Any, gid: bytes) -> list[bytes]:
        """The answers that wait in a channel."""
        found: list[bytes] = []
        try:
            while (reply := replies.try_recv()) is not None:
                self._on_reply(lambda data, *_: found.append(data), gid, reply)
        except zenoh.ZError:  # no more will come
            return found
        return found

    def _unpacked(self, attached: zenoh.ZBytes | None) -> attachments.Attachment | None:
        try:
            return attachments.unpack(b"" if attached is None else attached.to_bytes())
        except ValueError as error:
            self.malformed.add(str(error))
            return None


class _Presence:
    """A token, and what was declared before it. They go in the opposite order."""

    def __init__(self, token: zenoh.LivelinessToken, gid: bytes, *declared: Any) -> None:
        self.gid = gid
        self._parts = (token, *declared)

    def close(self) -> None:
        for part in self._parts:
            _undeclare(part)


class _Publication(_Presence):
    def __init__(
        self, token: zenoh.LivelinessToken, gid: bytes, publisher: Any, assert_alive: Callable[[], None]
    ) -> None:
        super().__init__(token, gid, publisher)
        self.assert_alive = assert_alive
        self._put = publisher.put

    def put(self, data: bytes, number: int, stamp: int) -> None:
        try:
            self._put(data, attachment=attachments.pack(number, stamp, self.gid))
        except (zenoh.ZError, RuntimeError):
            return  # closed meanwhile, or another thread is closing it


class _Asking(_Presence):
    def __init__(
        self,
        token: zenoh.LivelinessToken,
        gid: bytes,
        session: zenoh.Session,
        key: str,
        handler: Callable[[zenoh.Reply], None],
        timeout: float | None,
    ) -> None:
        super().__init__(token, gid)
        self._get = partial(
            session.get,
            key,
            timeout=timeout,
            **_TO_SERVERS,
        )
        self._handler = handler

    def ask(self, data: bytes, number: int, stamp: int) -> None:
        attachment = attachments.pack(number, stamp, self.gid)
        handler = Callback(self._handler, indirect=False)
        _quietly(lambda: self._get(handler, payload=data, attachment=attachment))


class _Serving:
    """A queryable with the queries that wait for their responses."""

    gid = b""

    def __init__(self, key: str) -> None:
        self._key = key
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._queries: dict[tuple[bytes, int], zenoh.Query] = {}
        self._presence: _Presence | None = None

    def follow(self, token: zenoh.LivelinessToken, gid: bytes, queryable: Any) -> None:
        self.gid = gid
        self._presence = _Presence(token, gid, queryable)

    def keep(self, query: zenoh.Query, client: bytes, number: int) -> bool:
        with self._lock:
            if (client, number) in self._queries or len(self._queries) >= _MOST_REQUESTS:
                return False
            self._queries[client, number] = query
        return True

    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        with self._lock:
            query = self._queries.pop((client, number), None)
        if query is None:
            return False
        attachment = attachments.pack(number, stamp, client)
        _quietly(lambda: query.reply(self._key, data, attachment=attachment))
        return True

    def close(self) -> None:
        if self._presence is not None:
            self._presence.close()
        self._queries.clear()


def _quietly(call: Callable[[], object]) -> None:
    """Do something that fails if the session, or the other side, is gone meanwhile."""
    try:
        call()
    except zenoh.ZError:
        return


def _undeclare(part: Any) -> None:
    """Undeclare something, once no other thread sends by it any more."""
    for _ in range(_MOST_TRIES):
        try:
            part.undeclare()
        except zenoh.ZError:
            return
        except RuntimeError:  # "Already borrowed"
            time.sleep(_BETWEEN_TRIES)
        else:
            return


def _blocks(qos: QosProfile) -> bool:
    return qos.reliability == RELIABLE and qos.history == KEEP_ALL


def _history(qos: QosProfile) -> int:
    return qos.queue_length or _KEPT_OF_ALL
