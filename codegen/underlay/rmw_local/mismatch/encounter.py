"""Two endpoints of one type whose definitions differ: what is decided when they meet.

Endpoints whose definitions are the same meet none of this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from rmw_local.message import Elsewhere
from rmw_local.mismatch.origin import Origin
from rmw_local.mismatch.passage import Converting, Downgrading, Marking

if TYPE_CHECKING:
    from ifgen_runtime.adapters import Adapter

    from rmw_local.message import MessageType
    from rmw_local.reader import Reader
    from rmw_local.service import ServiceClient, ServiceEndpoint, ServiceServer
    from rmw_local.writer import Writer

    Party: TypeAlias = Reader | Writer | ServiceEndpoint
    Ends = tuple[Any, Any]  # for each of two endpoints itself, or what stands for it

_WARN, _REFUSE, _ADAPT = "warn", "refuse", "adapt"


class Encounter(NamedTuple):
    """A pair of endpoints. `mine` is the one whose node's policy was applied: on a topic, the reader.

    `wanted` is that policy, and `policy` what came of it: a node that has no adapter refuses. Endpoints in
    two processes refuse each other, because the type hash is part of what a message is addressed to. Only
    who adapts also takes what is addressed to the other hash, or sends to it. There `mine` is the one here.
    """

    mine: Party
    theirs: Party
    wanted: str
    policy: str
    origin: Origin | None = None  # of messages, where they flow nevertheless
    converting: Converting | None = None  # what stands for theirs, if mine adapts a service across processes

    @property
    def crosses_processes(self) -> bool:
        """Whether one of the two is in another process."""
        return self.mine.is_remote or self.theirs.is_remote

    @property
    def adapts(self) -> bool:
        """Whether messages are converted between the two."""
        return self.policy == _ADAPT

    @property
    def withholds(self) -> bool:
        """Whether mine is to get nothing from anybody else either."""
        if self.policy == _ADAPT:
            return False
        return not self.crosses_processes or (self.mine.role == "subscription" and self.wanted != _WARN)


def meet_on_topic(writer: Writer, reader: Reader) -> tuple[Encounter, Origin | None]:
    """Decide about a writer and a reader; return where messages come from, None if the reader refuses.

    Called with the domain's lock held, as is `meet_on_service`.
    """
    if reader.is_remote:
        return _across_processes(reader, writer), None
    wanted = policy = _policy(reader, writer)
    adapter = None
    if wanted == _ADAPT:
        adapter = _adapter(writer.message_type, reader.message_type)
        policy = _REFUSE if adapter is None else _ADAPT
    if writer.is_remote and adapter is None:
        policy = _REFUSE
    origin = None if policy == _REFUSE else Origin("topic", reader.topic, writer.node, adapter)
    return Encounter(reader, writer, wanted, policy, origin), origin


def meet_on_service(client: ServiceClient, server: ServiceServer) -> tuple[Encounter, Ends | None]:
    """Decide about a client and a server; return what each of them is to the other, None if one refuses.

    Whoever refuses decides. Else whoever adapts does, the server first.
    """
    if client.is_remote or server.is_remote:
        return _meet_across_processes(client, server)
    sides: list[tuple[ServiceEndpoint, ServiceEndpoint]] = [(server, client), (client, server)]
    for mine, theirs in sides:
        if _policy(mine, theirs) == _REFUSE:
            return Encounter(mine, theirs, _REFUSE, _REFUSE), None
    adapting = [(mine, theirs) for mine, theirs in sides if _policy(mine, theirs) == _ADAPT]
    for mine, theirs in adapting:
        ends = _adapted(mine, theirs)
        if ends is not None:
            return Encounter(mine, theirs, _ADAPT, _ADAPT), ends if mine is client else ends[::-1]
    if adapting:
        return Encounter(*adapting[0], _ADAPT, _REFUSE), None
    ends = (Marking(client, _origin(server)), Marking(server, _origin(client)))
    return Encounter(server, client, _WARN, _WARN), ends


def _policy(mine: Party, theirs: Party) -> str:
    """The policy of a node; only to warn of a class without a type hash, whose definition nobody knows."""
    return mine.node.on_type_mismatch if mine.kind.type_hash and theirs.kind.type_hash else _WARN


def _across_processes(one: Party, other: Party) -> Encounter:
    mine, theirs = (other, one) if one.is_remote else (one, other)
    return Encounter(mine, theirs, _policy(mine, theirs), _REFUSE)


def _meet_across_processes(client: ServiceClient, server: ServiceServer) -> tuple[Encounter, Ends | None]:
    mine, theirs = (server, client) if client.is_remote else (client, server)
    if theirs.refuses:
        return Encounter(mine, theirs, _REFUSE, _REFUSE), None
    wanted = _policy(mine, theirs)
    converting = _converting(mine, theirs) if wanted == _ADAPT else None
    if converting is None:
        return Encounter(mine, theirs, wanted, _REFUSE), None
    ends = (converting, server) if theirs is client else (client, converting)
    return Encounter(mine, theirs, _ADAPT, _ADAPT, converting=converting), ends


def _converting(mine: ServiceEndpoint, theirs: ServiceEndpoint) -> Converting | None:
    """Return what stands for theirs, which is in another process, if mine adapts; None without adapters."""
    from ifgen_runtime.adapters import adapter_for  # late: only nodes that adapt need it

    # Only the hash of the whole service is known, not those of its parts.
    incoming = adapter_for(theirs.kind.type_hash, mine.takes.cls)
    outgoing = adapter_for(theirs.kind.type_hash, mine.sends.cls)
    if incoming is None or outgoing is None or outgoing.downgrade is None:
        return None
    return Converting(theirs, _origin(theirs, incoming), _origin(theirs, outgoing), mine)


def _adapted(mine: ServiceEndpoint, theirs: ServiceEndpoint) -> Ends | None:
    """Return mine and theirs, or their stand-ins, if mine adapts; None if an adapter is missing.

    What mine takes is upgraded, and what it sends is downgraded.
    """
    to_mine: Any = mine
    if theirs.sends.type_hash != mine.takes.type_hash:
        adapter = _adapter(theirs.sends, mine.takes)
        if adapter is None:
            return None
        to_mine = Marking(mine, _origin(theirs, adapter))
    to_theirs: Any = theirs
    if theirs.takes.type_hash != mine.sends.type_hash:
        adapter = _adapter(theirs.takes, mine.sends)
        if adapter is None or adapter.downgrade is None:
            return None
        to_theirs = Downgrading(theirs, _origin(theirs, adapter), mine.sends, mine.node)
    return to_mine, to_theirs


def _adapter(theirs: MessageType, mine: MessageType) -> Adapter | None:
    # Late, both: only nodes that adapt need them.
    from ifgen_runtime.adapters import adapter_for
    from ifgen_runtime.mismatch.conversion import adapter_between

    if theirs.cls is Elsewhere:  # so no adapter can follow from those of its fields
        return adapter_for(theirs.type_hash, mine.cls)
    return adapter_between(theirs.cls, mine.cls)


def _origin(peer: ServiceEndpoint, adapter: Adapter | None = None) -> Origin:
    return Origin("service", peer.name, peer.node, adapter)
