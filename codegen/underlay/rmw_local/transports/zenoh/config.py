"""Zenoh's configuration for a domain: ours, or the user's file, and the overrides."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import zenoh

from rmw_local.notices import say
from rmw_local.transports.errors import TransportError

if TYPE_CHECKING:
    from rmw_local.transports.environment import Environment

_OURS: Final[dict[str, object]] = {
    "mode": "peer",
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": True,
    # `open` must not wait for anybody: the graph is waited for where that is wanted.
    "scouting/delay": 0,
    "open/return_conditions/connect_scouted": False,
    "open/return_conditions/declares": False,
    # Who is expected may take a moment to listen. Who has gone is not looked for for ever.
    "connect/timeout_ms": {"peer": 10_000},
    "connect/exit_on_failure": False,
    "connect/retry": {"period_init_ms": 20, "period_max_ms": 1000, "period_increase_factor": 2},
    "timestamping/enabled": True,  # transient local needs it
    "queries_default_timeout": 600_000,
    "transport/link/tx/queue/size/data": 16,  # batches of 64 kB: bursts of keep-last messages are not lost
}


def configuration(environment: Environment, listen: Sequence[str], connect: Sequence[str]) -> zenoh.Config:
    """The configuration of a session that listens and connects to these endpoints besides.

    Raises TransportError if the user's file cannot be used.
    """
    if environment.config_file:
        config = _from_file(environment.config_file)
    else:
        config = zenoh.Config()
        settings = dict(_OURS)
        if environment.subnet:
            settings["scouting/multicast/enabled"] = True
            listen = [*listen, "tcp/[::]:0"]
        settings["listen/endpoints"] = list(listen)
        settings["connect/endpoints"] = list(connect)
        if environment.routers:
            # Routers pass nothing on between peers: they expect these to connect to each other.
            settings["mode"] = "client"
            settings["connect/timeout_ms"] = 1000
            settings["listen/endpoints"] = []
            settings["connect/endpoints"] = list(environment.routers)
        for path, value in settings.items():
            config.insert_json5(path, json.dumps(value))
    for path, text in environment.overrides:
        try:
            config.insert_json5(path, text)
        except zenoh.ZError as error:
            say(f"ZENOH_CONFIG_OVERRIDE: {path}={text} is ignored: {error}")
    return config


def _from_file(file: str) -> zenoh.Config:
    try:
        return zenoh.Config.from_file(file.removeprefix("file://"))
    except zenoh.ZError as error:
        raise TransportError(f"ZENOH_SESSION_CONFIG_URI: {file} cannot be used: {error}") from None
