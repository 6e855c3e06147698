"""When a domain is linked to other processes: as soon as there are others, and no sooner.

A process that is alone has a doorbell and no session. The environment can ask for more (`environment`), or
switch it off. Under a virtual clock, nothing crosses processes.
"""

from __future__ import annotations

import _thread
import atexit
import itertools
import os
import time
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, ClassVar, Final

from ifgen_runtime.domains.neighbours import BELL

from rmw_local.notices import say
from rmw_local.transports import ConfigurationError, TransportError
from rmw_local.transports.doorbell import CLOCK, IS_POSSIBLE, Doorbell

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rmw_local.domain import Domain
    from rmw_local.transports.environment import Environment
    from rmw_local.transports.link import Link
    from rmw_local.transports.zenoh.engine import ZenohTransport

# Late imports: of the link and of Zenoh, when there is somebody to talk to; of settings, when there are any.

_LATE: Final = (
    "ifgen_runtime.adapters",
    "ifgen_runtime.codec.decoding",
    "ifgen_runtime.codec.encoding",
    "ifgen_runtime.installation",
    "ifgen_runtime.mismatch.conversion",
    "ifgen_runtime.mismatch.reporting",
    "ifgen_runtime.type_description",
    "importlib.util",
    "rmw_local.content_filter",
    "rmw_local.mismatch.encounter",
    "rmw_local.mismatch.origin",
    "rmw_local.mismatch.encounter",
    "rmw_local.mismatch.reporting",
    "rmw_local.statistics",
    "rmw_local.transports.environment",
    "rmw_local.transports.link",
    "rmw_local.transports.receipts",
    "rmw_local.transports.reporter",
    "rmw_local.transports.zenoh.config",
    "rmw_local.transports.zenoh.engine",
)
"""The modules that threads of ours, and Zenoh's, import when they need them."""

_PATIENCE: Final = 1.0  # [s] until endpoints count as unmatched where Zenoh is missing
_CHECK_EVERY: Final = 1.0  # [s], for a router
_WITHOUT_SOCKETS: Final = (
    "where Python has no Unix sockets. Set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET, or start `ifgen router` and "
    "set ROS_STATIC_PEERS=127.0.0.1"
)
_CONNECTING: Final = 0.1  # [s] that a connection takes at most, on a sound network
_OF_FURTHER: Final = (
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ZENOH_SESSION_CONFIG_URI",
    "ZENOH_CONFIG_OVERRIDE",
)
_BACKGROUND: Final = ("/rosout", "/parameter_events")
_OF_EVERY_NODE: Final = (
    "/describe_parameters",
    "/get_parameter_types",
    "/get_parameters",
    "/get_type_description",
    "/list_parameters",
    "/set_parameters",
    "/set_parameters_atomically",
)


class Discovery:
    """The way of one domain to other processes."""

    all: ClassVar[list[Discovery]] = []

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._environment = _environment()
        self._bell: Doorbell | None = None
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._link: Link | None = None
        self._transport: ZenohTransport | None = None
        self._has_begun = self._has_ended = False
        self._rung_at = 0  # how many processes were there before this one
        self._has_said = False
        self.all.append(self)

    def begin(self) -> None:
        """Look for others, and let them find this process."""
        if _inherited_sessions:
            say(
                "other processes are not reached: this process was forked from one that reaches them, and "
                "Zenoh works in no fork. Start it with 'spawn' or 'forkserver' of multiprocessing"
            )
            return
        further = self._environment
        if IS_POSSIBLE and not (further and (further.config_file or further.routers)):
            try:
                self._bell = Doorbell(self._domain.number)
            except TransportError as error:
                say(f"other processes are not reached: {error}")
        if self._bell is not None:
            if self._bell.is_beside(CLOCK):
                number = self._domain.number
                _say_that_time_differs(f"another program in ROS domain {number}", "it is")
            # Not threading's: a program counts its own threads.
            _thread.start_new_thread(self._listen, ())
        if self._bell is not None:
            self._rung_at = self._bell.ring()
        if self._rung_at or further is not None:
            self._open()
        elif not IS_POSSIBLE:
            self._say_later(_WITHOUT_SOCKETS)

    def lacks_zenoh(self) -> bool:
        """Whether other processes are there, but not reached because Zenoh is not installed."""
        from importlib.util import find_spec

        return self._rung_at > 0 and self._link is None and find_spec("zenoh") is None

    def knows_everybody(self) -> bool:
        """Whether the graph has everybody who was there before this process, as far as that can be known.

        That takes a moment: other processes may still open their sessions. Machines in the subnet, and those
        that a file of Zenoh's configuration reaches, may always be more.
        """
        link, transport, further = self._link, self._transport, self._environment
        if link is None or transport is None:
            return not self._has_begun  # alone; or without Zenoh, a router or a session
        if further is not None and not further.routers:
            return False
        announced = transport.announced(0 if further else self._rung_at)
        return announced is not None and all(link.others.get(gid) for gid in announced)

    def stay_apart(self) -> None:
        """Discovery nobody, because of a virtual clock. Whoever comes second says so."""
        if not IS_POSSIBLE:
            return
        with suppress(TransportError):
            self._bell = Doorbell(self._domain.number, CLOCK)
            if self._bell.is_beside(BELL, CLOCK):
                others = f"others in ROS domain {self._domain.number} are"
                _say_that_time_differs("this program", others)

    def end(self) -> None:
        """Leave."""
        with self._lock:
            self._has_begun = self._has_ended = True
            link, self._link = self._link, None
            bell, self._bell = self._bell, None
        if bell is not None:
            bell.close()
        if link is not None:
            link.close()

    def forget(self) -> None:
        """Let go of what belongs to the process that this one was forked from, and touch none of it."""
        if self._bell is not None:
            self._bell.abandon()
        if self._link is not None:
            self._link.forget()
        if self._transport is not None:
            _inherited_sessions.append(self._transport)
        _inherited.append(self)
        self._domain.discovery = None

    def _listen(self) -> None:
        bell = self._bell
        if bell is not None:
            bell.listen(self._open, lambda: _count_nodes(self._domain))

    def _open(self) -> None:
        """Open the session, once."""
        with self._lock:
            if self._has_begun:
                return
            self._has_begun = True
        further = self._environment
        if further is None or not further.expects_router:
            self._attempt()
        elif not self._attempts(range(further.router_checks)):
            # The program goes on meanwhile.
            _thread.start_new_thread(self._attempts, (itertools.count(further.router_checks),))
        elif further.config_file:  # sessions by it may open before there is a router
            self._wait_for_router(further.router_checks)

    def _attempts(self, numbers: Iterable[int]) -> bool:
        """Try to open a session, which may need a router, again and again; returns whether that is done."""
        for attempt in numbers:
            if attempt:
                time.sleep(_CHECK_EVERY)
            if self._has_ended or self._attempt():
                return True
        return False

    def _attempt(self) -> bool:
        """Try to open a session; returns False if it may help to try again."""
        with self._lock:
            if self._has_ended:
                return True
            try:
                self._link = self._opened()
            except ModuleNotFoundError:
                from ifgen_runtime.installation import add_runtime

                self._say_later(f"without Zenoh. Install it: {add_runtime()}")
            except ConfigurationError as error:
                say(f"other processes are not reached: {error}")
            except TransportError as error:
                self._say_why_not(error)
                return False
        return True

    def _opened(self) -> Link:
        from rmw_local.transports.environment import Environment
        from rmw_local.transports.link import Link
        from rmw_local.transports.zenoh.config import configuration
        from rmw_local.transports.zenoh.engine import ZenohTransport

        bell = self._bell
        listen, connect = ([bell.endpoint], bell.others()) if bell is not None else ([], [])
        settings = self._environment or Environment()
        self._transport = ZenohTransport(
            self._domain.number,
            lambda: configuration(settings, listen, connect),
            is_private=settings.is_private,
        )
        link = Link(self._domain, self._transport)
        link.open()
        return link

    def _wait_for_router(self, checks: int) -> None:
        """Look for a router as often as that, and say each time that there is none."""
        for check in range(checks):
            time.sleep(_CHECK_EVERY if check else _CONNECTING)
            if self._link is None or self._transport is None or self._transport.knows_router():
                return
            say("no Zenoh router is connected: is one running, and is its address right?")

    def _say_why_not(self, error: TransportError) -> None:
        if self._has_said:
            return
        self._has_said = True
        further, until = self._environment, ""
        if further is not None and further.config_file:
            until = f" until there is a router as {further.config_file} says"
        elif further is not None and further.routers:
            until = f" until there is a router at {' or '.join(further.routers)}"
        say(f"other processes are not reached{until}: {error}")

    def _say_later(self, why: str) -> None:
        """Say why other processes are not reached, once an endpoint waits for somebody."""
        _thread.start_new_thread(self._say_if_lonely, (why,))

    def _say_if_lonely(self, why: str) -> None:
        time.sleep(_PATIENCE)
        lonely = _unmatched(self._domain)
        if lonely:
            say(f"{lonely} has no counterpart in this process, and other processes are not reached {why}")


def _say_that_time_differs(who: str, whom: str) -> None:
    say(
        f"{who} runs on a virtual clock, so {whom} not reached: start them together in lockstep, with `ifgen "
        "run --lockstep`, or set ROS_AUTOMATIC_DISCOVERY_RANGE=OFF for one that is to be alone"
    )


def _environment() -> Environment | None:
    """The settings of whoever wants to reach further than to this user's processes; None for all others."""
    if not any(os.environ.get(name) for name in _OF_FURTHER):
        return None
    from rmw_local.transports import environment

    settings = environment.read()
    return settings if settings.reaches_further else None


def _count_nodes(domain: Domain) -> int:
    """Count the nodes of this process in a domain, except hidden ones."""
    with domain.lock:
        return sum(not node.is_remote and "/_" not in node.full_name for node in domain.nodes)


def _unmatched(domain: Domain) -> str:
    """Name an endpoint that has nobody to talk to; empty if all have, those of every node aside."""
    with domain.lock:
        for topic in domain.topics.values():
            if topic.name in _BACKGROUND or "/_" in topic.name:
                continue
            for endpoint in (*topic.writers, *topic.readers):
                if not endpoint.matched.current:
                    return f"the topic '{topic.name}' of {endpoint.node.full_name}"
        for service in domain.services.values():
            if service.name.endswith(_OF_EVERY_NODE):
                continue
            for client in service.clients:
                if not client.servers:
                    return f"the client of '{service.name}' of {client.node.full_name}"
            for server in service.servers:
                if not server.clients:
                    return f"the service '{service.name}' of {server.node.full_name}"
    return ""


def _leave() -> None:
    for each in Discovery.all:
        each.end()


def _load() -> None:
    """Import what a thread of ours may be importing: a fork meanwhile would wait for that thread for ever."""
    if Discovery.all:
        for name in _LATE:
            with suppress(ImportError):  # Zenoh may be missing
                import_module(name)


def _forget() -> None:
    for each in Discovery.all:
        each.forget()
    Discovery.all.clear()


_inherited: list[Discovery] = []  # What would end with an object, such as a session, must not end in a fork.
_inherited_sessions: list[object] = []  # A fork has none of Zenoh's threads; opening a session hangs there.
atexit.register(_leave)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_load, after_in_child=_forget)
