"""The side of one process in a lockstep run: what waits for the end of the round, and the exchange there."""

from __future__ import annotations

import itertools
import pickle
import socket
from collections.abc import Callable, Iterable
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Final

from rmw_local.lockstep.transport import Item, LockstepTransport, Order

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.transports.interface import Entity


_HEAD: Final = 8  # bytes that say how long the rest is
_AT_ONCE: Final = 1 << 17  # bytes


class Channel:
    """One end of the way between the coordinator and a process: whole objects over a socket.

    Both ends are processes of one program, so what comes is trusted. They take turns: while one sends much,
    the other one waits for it. So neither can be blocked by the other.
    """

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        self._rest = b""  # that came with the last object

    def be_patient(self, seconds: float) -> None:
        """Wait no longer for the other end [s, real time]; at first there is no limit."""
        self._end.settimeout(seconds)

    def send(self, what: Any) -> None:
        """Send an object. Raises OSError if the other end is gone."""
        data = pickle.dumps(what, pickle.HIGHEST_PROTOCOL)
        self._end.sendall(len(data).to_bytes(_HEAD, "little") + data)

    def receive(self) -> Any:
        """Wait for an object. Raises EOFError if the other end is gone, TimeoutError if it takes too long."""
        data = self._rest or self._some()
        while len(data) < _HEAD:
            data += self._some()
        size = int.from_bytes(data[:_HEAD], "little") + _HEAD
        if len(data) < size:
            parts, left = [data], size - len(data)
            while left > 0:
                part = self._some()
                parts.append(part)
                left -= len(part)
            data = b"".join(parts)
        self._rest = data[size:]
        return pickle.loads(memoryview(data)[_HEAD:size])

    def close(self) -> None:
        """Close it."""
        self._end.close()

    def _some(self) -> bytes:
        try:
            data = self._end.recv(_AT_ONCE)
        except ConnectionResetError:
            data = b""
        if not data:
            raise EOFError("the other end is gone")
        return data


Change = tuple[int, "Entity", bool]
"""A domain, an entity in it, and whether it has appeared or is gone."""

Mail = dict[int, list[Item]]
"""Messages by the number of the process that they are for."""

_by_place = itemgetter(0)


class Side:
    """Keeps what one process sends until the round ends; one thread at a time uses it."""

    def __init__(self, number: int, channel: Channel) -> None:
        self.number = number
        self.failure = ""
        """Why the run has failed, once it has."""
        self.is_over = False
        """Whether the run is over for this process: it goes on alone, to its end."""
        self._channel = channel
        self._sequence = itertools.count()
        self._held: list[tuple[Order, Callable[[Any], object], Any]] = []
        self._posted: list[Item] = []
        self._changes: list[Change] = []
        self._others: dict[bytes, Change] = {}  # by gid
        self._leaving: list[bytes] = []
        self._gone: list[int] = []
        self._transports: dict[int, LockstepTransport] = {}

    @property
    def keeps_something(self) -> bool:
        """Whether something waits that stays within this process."""
        return bool(self._held)

    def join(self, domain: Domain) -> None:
        """Let a domain of this process be one with those of the others."""
        if domain.number in self._transports:
            return
        from rmw_local.transports.link import Link  # late: it imports the graph, which imports this

        transport = self._transports[domain.number] = LockstepTransport(self, domain.number)
        Link(domain, transport).open()
        for number, entity, _ in self._others.values():
            if number == domain.number:
                transport.learn(entity, ())

    # What entities do

    def place(self, node: str, *, is_early: bool = False) -> Order:
        """The place of the next thing that a node sends.

        Within a round, things are delivered by the names of the nodes that have sent them, in the order in
        which each has. Earlier messages of a publisher, for late joiners, come before.
        """
        return node, 0 if is_early else 1, next(self._sequence), self.number

    def early(self, order: Order) -> Order:
        """The place of something that was sent before."""
        return (order[0], 0, *order[2:])

    def hold(self, node: str, deliver: Callable[[Any], object], what: Any, *, is_early: bool = False) -> None:
        """Deliver within this process when the round ends."""
        self._held.append((self.place(node, is_early=is_early), deliver, what))

    def post(self, item: Item) -> None:
        """Send to other processes when the round ends."""
        self._posted.append(item)

    def tell(self, domain: int, entity: Entity, *, appeared: bool) -> None:
        """Tell other processes when the round ends."""
        self._changes.append((domain, entity, appeared))

    # The end of a round

    def exchange(self, deadline: int | None, now: int) -> int:
        """Wait until all processes have nothing more to do, and deliver; returns the time then [ns, steady].

        `deadline` is when this process has something to do, if nothing comes [ns, steady; None: never].
        """
        if self._gone_alone():
            return now
        try:
            changes, self._changes = self._changes, []
            self._channel.send(("idle", deadline, now, bool(self._held), changes, self._mail()))
            return self._await_turn(now)
        except (EOFError, OSError):
            self._fail("the process that coordinates it is gone")
            return now

    def farewell(self, how: tuple[Any, ...]) -> None:
        """Tell how this process ends, with all that it has still sent."""
        if not self.is_over:  # otherwise nobody listens
            self.is_over = True
            self._channel.send(("ended", how, self._changes, self._mail()))

    def _await_turn(self, now: int) -> int:
        while True:
            what, *rest = self._channel.receive()
            if what == "graph":
                self._channel.send(("more", self._learn(*rest)))
            elif what == "go":
                now, mail = rest
                self._deliver(mail)
                return now
            else:
                (self.failure,) = rest
                self.is_over = True
                return now

    def _gone_alone(self) -> bool:
        """Deliver what stays within this process, if the run is over."""
        if self.is_over:
            self._deliver(())
        return self.is_over

    def _fail(self, why: str) -> None:
        self.failure, self.is_over = why, True

    def _mail(self) -> Mail:
        mail: Mail = {}
        for item in self._posted:
            for process in self._transports[item.domain].takers(item):
                mail.setdefault(process, []).append(item)
        return mail

    def _learn(self, changes: Iterable[Change], gone: Iterable[int]) -> Mail:
        """Get to know who has come, and answer with what they have missed; who goes may still be heard."""
        mail: Mail = {}
        for change in changes:
            domain, entity, has_appeared = change
            if not has_appeared:
                self._others.pop(entity.gid, None)
                self._leaving.append(entity.gid)
                continue
            self._others[entity.gid] = change
            transport = self._transports.get(domain)
            missed = transport.learn(entity, self._posted) if transport is not None else ()
            if missed:
                mail.setdefault(int(entity.peer), []).extend(missed)
        for process in gone:
            self._gone.append(process)
            self._others = {g: each for g, each in self._others.items() if each[1].peer != str(process)}
        return mail

    def _deliver(self, mail: Iterable[list[Item]]) -> None:
        held, self._held = self._held, []
        self._posted.clear()
        for items in mail:
            held += [(item.order, self._transports[item.domain].deliver, item) for item in items]
        held.sort(key=_by_place)
        for _, deliver, what in held:
            deliver(what)
        for transport in self._transports.values():
            for gid in self._leaving:
                transport.unlearn(gid)
            for process in self._gone:
                transport.unlearn_all(process)
        self._leaving.clear()
        self._gone.clear()
