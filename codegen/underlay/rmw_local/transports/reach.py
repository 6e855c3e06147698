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
from typing import TYPE_CHECKING, ClassVar, Final

from rmw_local.notices import say
from rmw_local.transports.doorbell import IS_POSSIBLE, Doorbell
from rmw_local.transports.errors import TransportError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rmw_local.graph import Domain
    from rmw_local.transports.environment import Environment
    from rmw_local.transports.link import Link
    from rmw_local.transports.zenoh.engine import ZenohTransport

# Late imports: of the link and of Zenoh, when there is somebody to talk to; of settings, when there are any.

_PATIENCE: Final = 1.0  # [s] until endpoints count as unmatched where Zenoh is missing
_CHECK_EVERY: Final = 1.0  # [s], for a router
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


class Reach:
    """The way of one domain to other processes."""

    all: ClassVar[list[Reach]] = []

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._environment = _environment()
        self._bell: Doorbell | None = None
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._link: Link | None = None
        self._transport: ZenohTransport | None = None
        self._has_begun = self._has_ended = False
        self._has_said = False
        self.all.append(self)

    def begin(self) -> None:
        """Look for others, and let them find this process."""
        further = self._environment
        if IS_POSSIBLE and not (further and (further.config_file or further.routers)):
            try:
                self._bell = Doorbell(self._domain.number)
            except TransportError as error:
                say(f"other processes are not reached: {error}")
        if self._bell is not None:
            # Not threading's: a program counts its own threads.
            _thread.start_new_thread(self._listen, ())
        is_not_alone = self._bell is not None and self._bell.ring()
        if is_not_alone or further is not None:
            self._open()

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
        _inherited.append(self)
        self._domain.reach = None

    def _listen(self) -> None:
        bell = self._bell
        if bell is not None:
            bell.listen(self._open)

    def _open(self) -> None:
        """Open the session, once."""
        with self._lock:
            if self._has_begun:
                return
            self._has_begun = True
        further = self._environment
        if further is None or not further.routers:
            if self._attempt() and further is not None:
                self._wait_for_router(further.router_checks)
        elif not self._attempts(range(further.router_checks)):
            _thread.start_new_thread(self._attempts, (itertools.count(1),))  # the program goes on meanwhile

    def _attempts(self, numbers: Iterable[int]) -> bool:
        """Try to open a session, which needs a router, again and again; returns whether that is done."""
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
                _thread.start_new_thread(self._say_what_is_missing, ())
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
            self._domain.number, lambda: configuration(settings, listen, connect)
        )
        link = Link(self._domain, self._transport)
        link.open()
        return link

    def _wait_for_router(self, checks: int) -> None:
        """Look for a router as often as that, and say each time that there is none."""
        for check in range(checks):
            time.sleep(_CHECK_EVERY if check else _CONNECTING)
            if self._transport is None or self._transport.knows_router():
                return
            say("no Zenoh router is connected: is one running, and is its address right?")

    def _say_why_not(self, error: TransportError) -> None:
        if self._has_said:
            return
        self._has_said = True
        routers = self._environment.routers if self._environment is not None else ()
        until = f" until there is a router at {' or '.join(routers)}" if routers else ""
        say(f"other processes are not reached{until}: {error}")

    def _say_what_is_missing(self) -> None:
        from ifgen_runtime.installation import add_extra

        time.sleep(_PATIENCE)
        lonely = _unmatched(self._domain)
        if lonely:
            say(
                f"{lonely} has no counterpart in this process, and other processes are not reached without "
                f"Zenoh. Install it: {add_extra('net')}"
            )


def _environment() -> Environment | None:
    """The settings of whoever wants to reach further than to this user's processes; None for all others."""
    if not any(os.environ.get(name) for name in _OF_FURTHER):
        return None
    from rmw_local.transports import environment

    settings = environment.read()
    return settings if settings.reaches_further else None


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
    for reach in Reach.all:
        reach.end()


def _forget() -> None:
    for reach in Reach.all:
        reach.forget()
    Reach.all.clear()


_inherited: list[Reach] = []  # What would end with an object, such as a session, must not end in a fork.
atexit.register(_leave)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
