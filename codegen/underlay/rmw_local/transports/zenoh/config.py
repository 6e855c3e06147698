"""Zenoh's configuration for a domain: ours, or the user's file, and the overrides, and its errors."""

from __future__ import annotations

import _socket  # socket itself takes 3 ms to import
import json
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import zenoh

from rmw_local.notices import say
from rmw_local.transports import ConfigurationError

if TYPE_CHECKING:
    from rmw_local.transports.environment import Environment


_IN_SOURCES: Final = re.compile(r" at /\S+?\.rs:\d+\.?")
"""A place in the code of Zenoh."""
_QUOTED: Final = re.compile(r"""(?:msg: |Str\()"((?:[^"\\]|\\.)*)""")
_PLACES: Final = (re.compile(r"--> (\d+):(\d+)"), re.compile(r"line: (\d+), column: (\d+)"))


def reason(error: Exception) -> str:
    """Return what an error says, in one line and without the places in Zenoh's code."""
    text = _IN_SOURCES.sub("", str(error))
    if quoted := _QUOTED.search(text):
        text = quoted[1].replace("\\n", "\n").replace('\\"', '"')
    text = text.rpartition("\n  = ")[2]  # after a picture of the place
    return " ".join(text.split()).rstrip(".!")


def place(error: Exception) -> str:
    """Return the place in the user's file that an error names, as `, line 2, column 1`, or nothing."""
    found = next(filter(None, (pattern.search(str(error)) for pattern in _PLACES)), None)
    return f", line {found[1]}, column {found[2]}" if found else ""


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
    # Ours is in `shared_memory`. With Zenoh's, a receiver that may not lock more memory loses messages
    # without a word, and the memory of every sender stays mapped when that is gone.
    "transport/shared_memory/enabled": False,
    "timestamping/enabled": True,  # transient local needs it
    "queries_default_timeout": 600_000,
    "transport/link/tx/queue/size/data": 16,  # batches of 64 kB: bursts of keep-last messages are not lost
}

_WAIT: Final = 20_000
"""Microseconds, once, for a full connection: bursts arrive that a keep-last history has room for."""
_ON_THIS_MACHINE: Final = "unixsock-stream"
_OF_OTHERS: Final = ("connect", "listen", "mode", "scouting")
"""Parts of the configuration that say who is to be found."""
_FILES: Final = tuple(
    f"transport/link/tls/{name}"
    for name in ("root_ca_certificate", "connect_certificate", "connect_private_key")
)


def configuration(environment: Environment, listen: Sequence[str], connect: Sequence[str]) -> zenoh.Config:
    """The configuration of a session that listens and connects to these endpoints besides.

    Raises ConfigurationError if the user's file, or one that it names, cannot be used.
    """
    if environment.config_file:
        config = _from_file(environment.config_file)
    else:
        config = zenoh.Config()
        settings = dict(_OURS)
        if environment.subnet:
            settings["scouting/multicast/enabled"] = True
            listen = [*listen, _everywhere()]
        settings["listen/endpoints"] = list(listen)
        settings["connect/endpoints"] = list(connect)
        if environment.routers:
            # Routers pass nothing on between peers: they expect these to connect to each other.
            settings["mode"] = "client"
            settings["connect/timeout_ms"] = 1000
            settings["listen/endpoints"] = []
            settings["connect/endpoints"] = list(environment.routers)
        elif not _leaves_the_machine(environment):
            # Peers tell each other of other peers, also one that has met peers elsewhere.
            settings["transport/link/protocols"] = [_ON_THIS_MACHINE]
            settings["transport/link/tx/queue/congestion_control/drop/wait_before_drop"] = _WAIT
        for path, value in settings.items():
            config.insert_json5(path, json.dumps(value))
    for path, text in environment.overrides:
        try:
            config.insert_json5(path, text)
        except zenoh.ZError as error:
            say(f"ZENOH_CONFIG_OVERRIDE: {path}={text} is ignored: {reason(error)}")
    _check_files(config)
    return config


def _everywhere() -> str:
    """The endpoint of all interfaces; a kernel without IPv6 has another one."""
    try:
        _socket.socket(_socket.AF_INET6).close()
    except OSError:
        return "tcp/0.0.0.0:0"
    return "tcp/[::]:0"


def _leaves_the_machine(environment: Environment) -> bool:
    return environment.subnet or any(path.startswith(_OF_OTHERS) for path, _ in environment.overrides)


def _from_file(file: str) -> zenoh.Config:
    try:
        return zenoh.Config.from_file(file.removeprefix("file://"))
    except zenoh.ZError as error:
        where = f"ZENOH_SESSION_CONFIG_URI: {file}{place(error)}"
        raise ConfigurationError(f"{where} cannot be used: {reason(error)}") from None


def _check_files(config: zenoh.Config) -> None:
    """Raise ConfigurationError for a file of TLS that is missing: Zenoh only says that it cannot connect."""
    for path in _FILES:
        file = json.loads(config.get_json(path))
        if file and not os.access(file, os.R_OK):
            raise ConfigurationError(f"{path}: there is no file {file!r} that can be read in {Path.cwd()}")
