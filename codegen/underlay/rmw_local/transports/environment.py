"""Environment variables about other processes, by the names of ROS and of rmw_zenoh."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from rmw_local.notices import say

_RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_LOCAL, _SUBNET = "LOCALHOST", "SUBNET"
_RANGES: Final = ("OFF", _LOCAL, _SUBNET, "SYSTEM_DEFAULT")  # where it is OFF, nobody asks further
_ROUTER_PORT: Final = 7447
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
    def reaches_further(self) -> bool:
        """Whether there may be others than this user's processes on this machine."""
        return bool(self.subnet or self.routers or self.config_file or self.overrides)


def read(variables: Mapping[str, str] = os.environ) -> Environment:
    """Read the variables. What is wrong in them is said on stderr, and left out."""
    reach = variables.get(_RANGE) or _LOCAL
    if reach not in _RANGES:
        say(f"{_RANGE} is {reach!r}, expected one of {', '.join(_RANGES)}: assuming {_LOCAL}")
        reach = _LOCAL
    config_file = variables.get("ZENOH_SESSION_CONFIG_URI", "")
    routers = _routers(variables.get("ROS_STATIC_PEERS", ""))
    attempts = variables.get("ZENOH_ROUTER_CHECK_ATTEMPTS", "")
    return Environment(
        subnet=reach == _SUBNET,
        routers=routers,
        config_file=config_file,
        overrides=_overrides(variables.get("ZENOH_CONFIG_OVERRIDE", "")),
        router_checks=_router_checks(attempts, bool(config_file or routers)),
    )


def _routers(text: str) -> tuple[str, ...]:
    """The hosts in ROS_STATIC_PEERS, each with or without a port, between semicolons."""
    return tuple(_endpoint(host.strip()) for host in text.split(";") if host.strip())


def _endpoint(host: str) -> str:
    if "/" in host:
        return host  # an endpoint of Zenoh, such as tls/host:7447
    is_bare_ipv6 = host.count(":") > 1 and not host.startswith("[")
    if is_bare_ipv6:
        return f"tcp/[{host}]:{_ROUTER_PORT}"
    has_port = ":" in host.rpartition("]")[2]
    return f"tcp/{host}" if has_port else f"tcp/{host}:{_ROUTER_PORT}"


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
