"""The transport: one Zenoh session, with a token for each entity."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager
from functools import partial
from typing import Any, Final
from weakref import WeakValueDictionary

import zenoh
from zenoh import CongestionControl, Locality, Reliability, SampleKind
from zenoh.ext import (
    CacheConfig,
    HistoryConfig,
    MissDetectionConfig,
    RecoveryConfig,
    declare_advanced_publisher,
    declare_advanced_subscriber,
)
from zenoh.handlers import FifoChannel

from rmw_local.notices import Repeated
from rmw_local.qos import KEEP_ALL, RELIABLE, TRANSIENT_LOCAL, QosProfile
from rmw_local.transports import TransportError
from rmw_local.transports.background import Background
from rmw_local.transports.interface import (
    Ask,
    Audience,
    Entity,
    Kind,
    OnEntity,
    OnOver,
    OnQuestion,
    OnReceipts,
    OnReply,
    OnRequest,
    OnSample,
    Receipt,
)
from rmw_local.transports.zenoh import attachments, inquiries, services, tokens
from rmw_local.transports.zenoh.calls import Calls
from rmw_local.transports.zenoh.config import reason
from rmw_local.transports.zenoh.presence import PATIENCE, Crowds, Gate, Presence, Publication
from rmw_local.transports.zenoh.services import Asking, Queried, Questions, Serving
from rmw_local.transports.zenoh.shared_memory import SharedMemory
from rmw_local.transports.zenoh.tokens import alive_key, data_key, receipts_key, settled_key, statistics_key

_KEPT_OF_ALL: Final = 10_000
"""The number of messages that are kept for late joiners where the history is "keep all"."""
_MOST_TOKENS: Final = 100_000
"""The number of announcements that wait: Zenoh hands them over before anybody can look, and stops for good
where there is no room.
"""
_MOST_ANSWERS: Final = 256
"""The number of answers to an inquiry that wait: more would hold up Zenoh until somebody looks."""
_HEARTBEAT: Final = 0.5  # [s], of transient local publishers
_PATIENCE: Final = 1.0  # [s], for what others have announced
_RUNTIME: Final = "(net: (worker_threads: 16))"
"""Zenoh's threads.

Zenoh's Python package undeclares a publisher that has a heartbeat while it holds the interpreter: it waits
for the task of that heartbeat, and the task for a thread. Zenoh has one such thread. Whenever a peer was
leaving at that moment, that thread waited for the interpreter, in a callback of ours, and both for 10 s. With
more threads, it takes as many peers that leave at once. They cost nothing while they wait.
"""


class ZenohTransport:
    """A `rmw_local.transports.interface.Transport`. The configuration is made when the session opens.

    `is_private` says that it connects this user's processes on this machine, and nobody else.
    """

    def __init__(
        self, domain: int, configuration: Callable[[], zenoh.Config], *, is_private: bool = False
    ) -> None:
        self._keeping: WeakValueDictionary[bytes, Publication] = WeakValueDictionary()
        self.malformed = Repeated("dropped {count} malformed message{s} from another process: {why}")
        self._gate = Gate()
        self._background = Background()
        self._domain = domain
        self._patterns = tokens.pattern(domain), *tokens.crowd_patterns(domain)
        self._configuration = configuration
        self._is_private = is_private
        self._questions: list[Questions] = []

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        """Open the session and follow the graph."""
        try:
            with _threads():
                self._session = zenoh.open(self._configuration())
        except zenoh.ZError as error:
            raise TransportError(f"Zenoh says: {reason(error)}") from None
        self._id = str(self._session.zid())
        self._liveliness = self._session.liveliness()
        parts = self._session, self._gate, self._background, self._domain, self.malformed
        self._shared_memory = SharedMemory(*parts, is_private=self._is_private)
        self._calls = Calls(*parts)
        self._crowds = Crowds(self._session, self._gate, self._domain, is_private=self._is_private)
        if self._is_private:
            self._calls.begin()
        self._followed: list[Any] = [
            *(
                self._liveliness.declare_subscriber(
                    pattern, self._gate.callback(self._on_token, on_entity), history=True
                )
                for pattern in self._patterns
            ),
            self._session.declare_subscriber(
                alive_key(self._domain, "*"),
                self._gate.callback(self._on_alive, on_alive),
                allowed_origin=Locality.REMOTE,
            ),
        ]

    def close(self) -> None:
        """Close the session, and wait for the threads that are using it."""
        self._calls.end()
        self._gate.shut()
        self._shared_memory.finish()
        self._background.end(PATIENCE)
        self._session.close()  # type: ignore[no-untyped-call]  # its stub has no return type
        self._shared_memory.close()
        self._gate.wait()

    def knows_router(self) -> bool:
        """Whether a router is connected."""
        found: list[object] = []
        self._gate.call(lambda: found.extend(self._session.info.routers_zid()))
        return bool(found)

    def announced(self, peers: int) -> list[bytes] | None:
        """Ask all others for what they have announced, and return the gids; a moment later, all have come.

        None if fewer than that many processes have settled, or if no peer and no router is connected, or if
        they are late.
        """
        answers: list[str] | None = None

        def ask() -> None:
            nonlocal answers
            if self._session.info.peers_zid() or self._session.info.routers_zid():
                settled = self._tokens(settled_key(self._domain, "*"))
                own = settled_key(self._domain, self._id)
                if settled is not None and len({*settled} - {own}) >= peers:
                    found = [self._tokens(pattern) for pattern in self._patterns]
                    answers = None if None in found else [token for each in found for token in each or ()]

        self._gate.call(ask)
        if answers is None:
            return None
        return [tokens.gid_of(token) for token in answers if tokens.session_of(token) != self._id]

    def _tokens(self, pattern: str) -> list[str] | None:
        """The tokens that others and this process have declared; None if some may be missing."""
        channel: Any = FifoChannel(_MOST_TOKENS)
        end = time.monotonic() + _PATIENCE
        replies = list(self._liveliness.get(pattern, channel, timeout=_PATIENCE))
        if time.monotonic() > end:
            return None
        return [tokens.of_key(str(reply.ok.key_expr)) for reply in replies if reply.ok is not None]

    def settle(self) -> None:
        """Declare one more token: others learn of tokens in the order in which they were declared."""
        self._followed.append(self._liveliness.declare_token(settled_key(self._domain, self._id)))

    def acknowledge(self, on_receipts: OnReceipts) -> None:
        """Declare a queryable for all publishers of others."""
        self._followed.append(
            self._session.declare_queryable(
                receipts_key(self._domain, self._id),
                self._gate.callback(self._on_question, on_receipts),
                complete=True,
                allowed_origin=Locality.REMOTE,
            )
        )

    def offer(self, on_question: OnQuestion) -> None:
        """Declare a queryable for whoever asks."""
        key = statistics_key(self._domain, self._id)
        self._followed.append(
            self._session.declare_queryable(
                key,
                self._gate.callback(inquiries.answer_statistics, on_question, key),
                allowed_origin=Locality.REMOTE,
            )
        )

    def survey(self, patience: float) -> Callable[[], Iterable[bytes]]:
        """Send one query to all processes."""
        return inquiries.ask_statistics(
            self._gate, self._session, statistics_key(self._domain, "*"), patience
        )

    def announce(self, node: Entity) -> Presence:
        """Declare a node's token."""
        return Presence(self._gate, *self._token(node))

    def publish(self, publisher: Entity, audience: Audience) -> Publication:
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
            declared = self._crowds.publisher(key, **options)
        token, gid = self._token(publisher)
        say_alive, ask = partial(self._say_alive, gid), partial(self._receipts, gid)
        publication = Publication(self._gate, token, gid, declared, say_alive, ask)
        if qos.durability == TRANSIENT_LOCAL:
            self._keeping[gid] = publication
        else:  # what is kept for late joiners would stay lent
            lend = partial(self._shared_memory.lend, key, audience, options["congestion_control"])
            publication.shorten(lend, self._shared_memory.threshold)
        return publication

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> Presence:
        """Declare a subscriber, for a transient local one also what asks for earlier messages."""
        qos, key = subscription.qos, self._key(subscription)
        handler = partial(self._on_sample, on_sample)
        declared: Any
        if qos.durability == TRANSIENT_LOCAL:
            reliable = qos.reliability == RELIABLE
            declared = declare_advanced_subscriber(
                self._session,
                key,
                self._gate.callback(handler),
                allowed_origin=Locality.REMOTE,
                history=HistoryConfig(detect_late_publishers=True, max_samples=_history(qos)),
                recovery=RecoveryConfig(periodic_queries=None, heartbeat=True) if reliable else None,
                subscriber_detection=True,
            )
        else:
            declared = self._crowds.subscriber(key, handler)
        token = self._written(subscription)
        listening = self._shared_memory.listen(tokens.gid_of(token), key, on_sample)
        return Presence(self._gate, *self._declared(token), declared, listening)

    def ask(self, client: Entity, on_reply: OnReply, on_over: OnOver) -> Asking:
        """Declare a client's token."""
        token, gid = self._token(client)
        ask = self.ask_also(client, gid, on_reply, on_over)
        caller = self._calls.caller(gid, on_reply, on_over)
        return Asking(self._questions, self._gate, token, gid, ask, caller, self._calls)

    def ask_also(self, client: Entity, gid: bytes, on_reply: OnReply, on_over: OnOver) -> Ask:
        """Declare nothing: a query needs a key only."""
        patience = services.patience(client.name)
        get = partial(self._session.get, self._key(client), timeout=patience, **services.TO_SERVERS)
        replied = partial(self._on_reply, on_reply, gid)
        return Questions(
            self._questions, client.name, self._gate, self._background, gid, get, replied, on_over
        ).ask

    def inquire(self, server: Entity, data: bytes, patience: float) -> Callable[[], Iterable[bytes]]:
        """Send a query under a gid that nobody else has seen."""
        gid = os.urandom(attachments.GID)  # secrets would cost 4 MB
        attachment = attachments.pack(1, time.time_ns(), gid)
        # A channel has no code of Python. A callback that Zenoh's threads drop while Python ends is fatal.
        channel: Any = FifoChannel(_MOST_ANSWERS)
        key = self._key(server)
        try:
            replies = self._session.get(
                key, channel, payload=data, attachment=attachment, timeout=patience, **services.TO_SERVERS
            )
        except zenoh.ZError:  # closed meanwhile
            return tuple
        return partial(self._answers, replies, gid)

    def serve(self, server: Entity, on_request: OnRequest) -> Serving:
        """Declare a queryable."""
        serving, key = Serving(self._gate), self._key(server)
        handler = self._gate.callback(self._on_request, on_request, serving, key)
        declared = self._session.declare_queryable(
            key, handler, complete=True, allowed_origin=Locality.REMOTE
        )
        token = self._written(server)
        listed = self._calls.serve(tokens.gid_of(token), serving, on_request)
        serving.follow(*self._declared(token), declared, listed)
        return serving

    def _key(self, endpoint: Entity) -> str:
        return data_key(self._domain, endpoint.name, endpoint.type_name, endpoint.type_hash)

    def _token(self, entity: Entity) -> tuple[zenoh.LivelinessToken, bytes]:
        """Declare a token, after what it tells of; returns it with the gid."""
        return self._declared(self._written(entity))

    def _written(self, entity: Entity) -> str:
        return tokens.write(self._domain, self._id, entity)

    def _declared(self, token: str) -> tuple[zenoh.LivelinessToken, bytes]:
        return self._crowds.token(token), tokens.gid_of(token)

    def _say_alive(self, gid: bytes) -> None:
        self._gate.call(lambda: self._session.put(alive_key(self._domain, gid.hex()), b""))

    # Callbacks, on Zenoh's threads

    def _on_token(self, on_entity: OnEntity, sample: zenoh.Sample) -> None:
        text = tokens.of_key(str(sample.key_expr))
        if tokens.session_of(text) == self._id:
            return
        try:
            entity = tokens.read(text)
        except ValueError as error:
            self.malformed.add(str(error))
            return
        appeared = sample.kind == SampleKind.PUT
        if entity.kind is Kind.NODE and not appeared:
            self._shared_memory.release(entity.peer)
        on_entity(entity, appeared)
        if entity.kind is Kind.SERVER and not appeared:
            for questions in tuple(self._questions):
                if questions.service == entity.name:
                    questions.lose_server()

    def _on_alive(self, on_alive: Callable[[bytes], None], sample: zenoh.Sample) -> None:
        digits = str(sample.key_expr).rpartition("/")[2]
        try:
            on_alive(bytes.fromhex(digits))
        except ValueError as error:
            self.malformed.add(str(error))

    def _on_question(self, on_receipts: OnReceipts, query: zenoh.Query) -> None:
        try:
            inquiries.answer_receipts(on_receipts, query)
        except ValueError as error:
            self.malformed.add(str(error))

    def _receipts(self, gid: bytes, peer: str, patience: float) -> list[Receipt] | None:
        get = partial(self._session.get, receipts_key(self._domain, peer))
        try:
            return inquiries.ask_receipts(self._gate, get, gid, patience)
        except ValueError as error:
            self.malformed.add(str(error))
            return None

    def _on_sample(self, on_sample: OnSample, sample: zenoh.Sample) -> None:
        if sample.kind != SampleKind.PUT:
            return
        attached = sample.attachment
        if attached is None:  # some tools send without
            on_sample(sample.payload.to_bytes(), 0, time.time_ns(), b"")
            return
        known = self._unpacked(attached)
        # Zenoh asks all publishers for what they kept, those of this process too, which delivered it already.
        if known is not None and known.gid not in self._keeping:
            data = sample.payload.to_bytes()
            if len(data) >= self._shared_memory.threshold:
                self._shared_memory.keep()
            on_sample(data, *known)

    def _on_request(self, on_request: OnRequest, serving: Serving, key: str, query: zenoh.Query) -> None:
        known = self._unpacked(query.attachment)
        payload = query.payload
        if known is None:
            return
        if payload is None:
            self.malformed.add("a request has no data")
            return
        number, stamp, client = known
        refused = serving.keep(Queried(self._gate, key, query), client, number, len(payload))
        if refused:
            self.malformed.add(refused)
        else:
            on_request(payload.to_bytes(), number, stamp, client)

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


@contextmanager
def _threads() -> Generator[None]:
    """Let Zenoh have the threads that it needs, unless the user has chosen: it looks once in a process."""
    if "ZENOH_RUNTIME" in os.environ:
        yield
        return
    os.environ["ZENOH_RUNTIME"] = _RUNTIME
    try:
        yield
    finally:
        del os.environ["ZENOH_RUNTIME"]


def _blocks(qos: QosProfile) -> bool:
    return qos.reliability == RELIABLE and qos.history == KEEP_ALL


def _history(qos: QosProfile) -> int:
    return qos.queue_length or _KEPT_OF_ALL
