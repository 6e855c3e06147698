"""Environment variables about other processes, by the names of ROS and of rmw_zenoh."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from rmw_local.notices import say

_RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_PEERS: Final = "ROS_STATIC_PEERS"
_ONLY_HERE: Final = "ROS_LOCALHOST_ONLY"  # older than the two above, and before them if it is 1
_SECURITY: Final = "ROS_SECURITY_ENABLE"
_LOCAL, _SUBNET = "LOCALHOST", "SUBNET"
_RANGES: Final = ("OFF", _LOCAL, _SUBNET, "SYSTEM_DEFAULT")  # where it is OFF, nobody asks further
_ROUTER_PORT: Final = 7447
_LAST_PORT: Final = 65535
_PROTOCOLS: Final = ("tcp", "tls", "quic", "udp", "ws")
_NOT_IN_HOSTS: Final = frozenset(" \t,/")
_POOL: Final = 64 * 1024 * 1024  # bytes
_LARGE: Final = 192 * 1024  # bytes; below, notices cost more than copies save (benchmarks/processes.py)
_OF_NOBODY: Final = ("queries_default_timeout", "timestamping/", "transport/link/tx/", "transport/link/rx/")
"""Parts of Zenoh's configuration that do not change who is found, and who is kept out; others may."""
NO_END: Final = 2**31
"""A number of attempts."""


@dataclass(frozen=True, slots=True)
class Environment:
    """How far this process reaches. Without any setting: other processes of this user on this machine."""

    subnet: bool = False
    """All machines that multicast reaches are to be found."""
    routers: tuple[str, ...] = ()
    """Endpoints to connect to, as Zenoh writes them."""
    config_file: str = ""
    """A file with Zenoh's configuration, which replaces ours."""
    overrides: tuple[tuple[str, str], ...] = ()
    """Paths in Zenoh's configuration and their values as JSON5."""
    router_checks: int = 0
    """The number of times to look for a router before nodes are made."""

    @property
    def expects_router(self) -> bool:
        """Whether sessions may have to wait for somebody who connects them."""
        return bool(self.routers or self.config_file)

    @property
    def is_private(self) -> bool:
        """Whether only this user's processes on this machine are met, and Zenoh keeps none of them out."""
        is_plain = all(path.startswith(_OF_NOBODY) for path, _ in self.overrides)
        return is_plain and not (self.subnet or self.expects_router)

    @property
    def reaches_further(self) -> bool:
        """Whether there may be others than this user's processes on this machine."""
        return bool(self.subnet or self.routers or self.config_file or self.overrides)


def read(variables: Mapping[str, str] = os.environ) -> Environment:
    """Read the variables. What is wrong in them is said on stderr, and left out."""
    reach = variables.get(_RANGE) or _LOCAL
    if reach not in _RANGES:
        say(f"{_RANGE} is {reach!r}, expected one of {', '.join(_RANGES)}: assuming {_LOCAL}")
        reach = _LOCAL
    peers = variables.get(_PEERS, "")
    if variables.get(_ONLY_HERE) == "1" and (reach == _SUBNET or peers):
        say(f"{_ONLY_HERE} is 1, which comes before {_RANGE} and {_PEERS}: they are ignored")
        reach, peers = _LOCAL, ""
    config_file = variables.get("ZENOH_SESSION_CONFIG_URI", "")
    routers = _routers(peers)
    attempts = variables.get("ZENOH_ROUTER_CHECK_ATTEMPTS", "")
    if variables.get(_SECURITY) == "true" and (reach == _SUBNET or routers or config_file):
        say(f"{_SECURITY} is true, but there is no SROS 2 here: use TLS, or others can listen")
    return Environment(
        subnet=reach == _SUBNET,
        routers=routers,
        config_file=config_file,
        overrides=_overrides(variables.get("ZENOH_CONFIG_OVERRIDE", "")),
        router_checks=_router_checks(attempts, bool(config_file or routers)),
    )


def read_memory(variables: Mapping[str, str] = os.environ) -> tuple[int, int]:
    """The memory that a process may share, and the size of the messages that go through it [bytes]."""
    size = _bytes_of(variables, "ZENOH_SHM_ALLOC_SIZE", _POOL)
    return size, _bytes_of(variables, "ZENOH_SHM_MESSAGE_SIZE_THRESHOLD", _LARGE)


def _bytes_of(variables: Mapping[str, str], name: str, default: int) -> int:
    text = variables.get(name) or str(default)
    if text.isdecimal() and text.isascii():
        return int(text)
    say(f"{name} is {text!r}, expected a whole number of bytes: assuming {default}")
    return default


def _routers(text: str) -> tuple[str, ...]:
    """The hosts in ROS_STATIC_PEERS, each with or without a port, between semicolons."""
    found: list[str] = []
    for peer in filter(None, map(str.strip, text.split(";"))):
        endpoint = _endpoint(peer)
        if _can_be_reached(endpoint):
            found.append(endpoint)
        else:
            expected = "HOST, HOST:PORT or PROTOCOL/HOST:PORT, with semicolons between several"
            say(f"{_PEERS} has {peer!r}, expected {expected}: ignored")
    return tuple(found)


def _endpoint(host: str) -> str:
    if "/" in host:
        return host  # an endpoint of Zenoh, such as tls/host:7447
    is_bare_ipv6 = host.count(":") > 1 and not host.startswith("[")
    if is_bare_ipv6:
        return f"tcp/[{host}]:{_ROUTER_PORT}"
    has_port = ":" in host.rpartition("]")[2]
    return f"tcp/{host}" if has_port else f"tcp/{host}:{_ROUTER_PORT}"


def _can_be_reached(endpoint: str) -> bool:
    """Whether a network may have such an endpoint. Zenoh tries all for ever, and says nothing of mistakes."""
    protocol, _, place = endpoint.partition("/")
    host, _, port = place.partition("#")[0].partition("?")[0].rpartition(":")  # options may follow
    is_port = port.isdecimal() and port.isascii() and 0 < int(port) <= _LAST_PORT
    return protocol in _PROTOCOLS and is_port and bool(host) and not set(host) & _NOT_IN_HOSTS


def _overrides(text: str) -> tuple[tuple[str, str], ...]:
    pairs: list[tuple[str, str]] = []
    for pair in filter(None, map(str.strip, text.split(";"))):
        path, equals, value = pair.partition("=")
        if path.strip() and equals and value.strip():
            pairs.append((path.strip(), value.strip()))
        else:
            say(f"ZENOH_CONFIG_OVERRIDE has {pair!r}, expected path/in/configuration=value: ignored")
    return tuple(pairs)


def _router_checks(text: str, expects_router: bool) -> int:
    """The number of attempts, by rmw_zenoh's rule: unset is one, 0 is no end, less is none."""
    if not expects_router:
        return 0
    try:
        attempts = int(text or 1)
    except ValueError:
        say(f"ZENOH_ROUTER_CHECK_ATTEMPTS is {text!r}, expected a whole number: ignored")
        return 1
    return max(attempts, 0) if attempts else NO_END
