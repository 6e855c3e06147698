"""The configuration of a Zenoh router: a file, single values, options, and ours where these leave it open."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from ifgen.diagnostics import Diagnostic, Label, Source, Span, UsageError, shorten

if TYPE_CHECKING:
    import zenoh

# Late imports: Zenoh is not everywhere.

_PORT: Final = 7447
DEFAULT_ENDPOINT: Final = f"tcp/127.0.0.1:{_PORT}"
"""The default of `--listen`: rmw_zenohd's port, on this machine only."""

_FILE: Final = "ZENOH_ROUTER_CONFIG_URI"
_OVERRIDES: Final = "ZENOH_CONFIG_OVERRIDE"
_OURS: Final[dict[str, object]] = {
    "mode": "router",
    "listen/endpoints": [DEFAULT_ENDPOINT],
    "scouting/multicast/enabled": False,
    "scouting/delay": 0,  # nobody is looked for, so starting need not take half a second
    "connect/retry": {"period_init_ms": 1000, "period_max_ms": 4000, "period_increase_factor": 2},
    # As rmw_zenohd has them: many nodes may come at once, and they keep transient local messages by time.
    "timestamping/enabled": True,
    "transport/unicast/accept_pending": 10_000,
    "transport/unicast/max_sessions": 10_000,
}
_BY_ADDRESS: Final = ("tcp", "udp", "tls", "quic", "ws")  # with a host and a port
_ELSEWHERE: Final = ("serial", "unixsock-stream", "unixpipe", "vsock")
_ENDPOINT: Final = re.compile(
    r"(?:(?P<protocol>[^/]+)/)?(?P<host>\[[^]/]+\]|[^]/:[?#]+)(?::(?P<port>\d{1,6}))?(?P<rest>[?#].*)?"
)
_FILES_OF_TLS: Final = tuple(
    f"transport/link/tls/{name}"
    for name in (
        *("root_ca_certificate", "listen_private_key", "listen_certificate"),
        *("connect_private_key", "connect_certificate"),
    )
)
_PLACES: Final = (re.compile(r"--> (\d+):(\d+)"), re.compile(r"line: (\d+), column: (\d+)"))
_IN_SOURCES: Final = re.compile(r" at /\S+?\.rs:\d+\.?")
"""A place in the code of Zenoh."""
_QUOTED: Final = re.compile(r"""(?:msg: |Str\()"((?:[^"\\]|\\.)*)""")


def configuration(
    listen: Sequence[str], connect: Sequence[str], file: Path | None, variables: Mapping[str, str]
) -> zenoh.Config:
    """The configuration of a router; `listen` and `connect` are what `check_endpoint` accepts.

    Options come before ZENOH_CONFIG_OVERRIDE, and that before the file. What none of them changes is as
    `ifgen router` has it, which listens on this machine only. Raises UsageError for a mistake in any of them,
    and OSError if the file cannot be read.
    """
    import zenoh

    named = variables.get(_FILE, "").removeprefix("file://")
    if file is None and named:
        file = Path(named)
        if not file.is_file():
            raise _wrong(f"{_FILE}: there is no file {file}")
    config = zenoh.Config() if file is None else _from_file(file)
    for path, value in _overrides(variables.get(_OVERRIDES, "")):
        try:
            _set(config, path, value)
        except zenoh.ZError as error:
            raise _wrong(f"{_OVERRIDES}: {path}={value}: {reason(error)}") from None
    for option, endpoints in (("listen", listen), ("connect", connect)):
        if endpoints:
            _set_endpoints(config, option, endpoints)
    unset = zenoh.Config()
    for path, ours in _OURS.items():
        if config.get_json(path) == unset.get_json(path):
            _set(config, path, json.dumps(ours))
    if (mode := json.loads(config.get_json("mode"))) != "router":
        raise _wrong(f"{file or _OVERRIDES} has the mode '{mode}'", 'a router has `mode: "router"`, or none')
    _check_files(config)
    return config


def check_endpoint(endpoint: str) -> None:
    """Raise UsageError for an endpoint that Zenoh cannot use, with one that it could."""
    protocol, _, address = endpoint.partition("/")
    parts = _ENDPOINT.fullmatch(endpoint)
    if protocol in _ELSEWHERE and address:
        return
    if parts is None:
        advice = "expected tcp/HOST:PORT, where an IPv6 address is in brackets: tcp/[::1]:7447"
    elif parts["protocol"] not in (*_BY_ADDRESS, None):
        advice = f"the protocols are {', '.join(_BY_ADDRESS + _ELSEWHERE)}"
    else:
        has_port = 0 < int(parts["port"] or 0) < 2**16  # others must know it, so 0 will not do
        if has_port and parts["protocol"]:
            return
        port = parts["port"] if has_port else _PORT
        advice = f"write {parts['protocol'] or 'tcp'}/{parts['host']}:{port}{parts['rest'] or ''}"
    raise UsageError(
        [Diagnostic("wrong-endpoint", f"'{shorten(endpoint)}' is no endpoint of Zenoh", help=advice)]
    )


def endpoints_of(config: zenoh.Config, kind: Literal["listen", "connect"]) -> tuple[str, ...]:
    """The endpoints that a router listens on, or connects to. Groups of endpoints are left out."""
    found: list[object] | dict[str, list[object]] = json.loads(config.get_json(f"{kind}/endpoints"))
    listed = found.get("router", ()) if isinstance(found, dict) else found
    return tuple(endpoint for endpoint in listed if isinstance(endpoint, str))


def reason(error: Exception) -> str:
    """Return the words of an error of Zenoh in one line, without the places in its own code."""
    text = _IN_SOURCES.sub("", str(error))
    if quoted := _QUOTED.search(text):
        text = quoted[1].replace("\\n", "\n").replace('\\"', '"')
    text = text.rpartition("\n  = ")[2]  # after a picture of the place
    return " ".join(text.split()).rstrip(".")


def _set(config: zenoh.Config, path: str, value: str) -> None:
    config.insert_json5(path, value)  # pyright: ignore[reportUnknownMemberType]  # its stub has no return type


def _set_endpoints(config: zenoh.Config, option: str, endpoints: Sequence[str]) -> None:
    import zenoh

    try:
        _set(config, f"{option}/endpoints", json.dumps(endpoints))
    except zenoh.ZError as error:  # something after the port
        raise UsageError([Diagnostic("wrong-endpoint", f"--{option}: {reason(error)}")]) from None


def _from_file(file: Path) -> zenoh.Config:
    import zenoh

    text = file.read_text(encoding="utf-8", errors="replace")
    try:
        return zenoh.Config.from_file(file)
    except zenoh.ZError as error:
        what = f"{file} is no configuration of Zenoh: {reason(error)}"
        raise _wrong(what, place=_place(Source(file, text), str(error))) from None


def _check_files(config: zenoh.Config) -> None:
    """Raise UsageError for a file of TLS that is missing: Zenoh does not say which."""
    for path in _FILES_OF_TLS:
        name: str | None = json.loads(config.get_json(path))
        if name and not (Path(name).is_file() and os.access(name, os.R_OK)):
            advice = None if Path(name).is_absolute() else f"it is looked for in {Path.cwd()}"
            raise _wrong(f"{path}: there is no file '{name}' that can be read", advice)


def _overrides(text: str) -> list[tuple[str, str]]:
    """The pairs in ZENOH_CONFIG_OVERRIDE. One that is wrong may be meant to keep somebody out."""
    pairs: list[tuple[str, str]] = []
    for pair in filter(None, map(str.strip, text.split(";"))):
        path, equals, value = map(str.strip, pair.partition("="))
        if not (path and equals and value):
            raise _wrong(f"{_OVERRIDES} has '{pair}'", "expected path/in/configuration=value")
        pairs.append((path, value))
    return pairs


def _place(source: Source, error: str) -> Label | None:
    """The place in a file that an error of Zenoh names."""
    found = next(filter(None, (pattern.search(error) for pattern in _PLACES)), None)
    if found is None:
        return None
    line, column = map(int, found.groups())
    before = source.text.splitlines(keepends=True)[: line - 1]
    offset = sum(map(len, before)) + column - 1
    return Label(Span(source, offset, offset + 1))


def _wrong(what: str, advice: str | None = None, place: Label | None = None) -> UsageError:
    return UsageError([Diagnostic("router-configuration", what, place, help=advice)])
