"""`ifgen router`: a Zenoh router, where programs on several machines meet. It needs nothing of ROS."""

from __future__ import annotations

import errno
import os
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click
from ifgen.command_kit import terminal
from ifgen.command_kit.options import EXISTING_FILE
from ifgen.config import installing
from ifgen.diagnostics import Diagnostic, InputError, UsageError
from ifgen.signals import sigterm_raises

from ifgen_tools.running.router_configuration import (
    DEFAULT_ENDPOINT,
    check_endpoint,
    configuration,
    endpoints_of,
    reason,
)

if TYPE_CHECKING:
    import zenoh

# Late imports: Zenoh is not everywhere.

_LOOK_EVERY: Final = 1.0  # [s], for the routers that this one is to be connected to
_ANYWHERE: Final = "choose an endpoint of this machine, such as `--listen tcp/[::]:7447`"
_ADVICE: Final = {
    errno.EADDRINUSE: "is a router running already? otherwise choose another port with `--listen`",
    errno.EADDRNOTAVAIL: _ANYWHERE,
    errno.EACCES: "choose a port from 1024 with `--listen`",
}
_SYSTEM_ERROR: Final = re.compile(r"\(os error (\d+)\)")
_ON_THIS_MACHINE: Final = re.compile(r"\w+/(127\.[\d.]+|\[::1\]|localhost):|unix|serial")


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: ifgen router --listen tcp/127.0.0.1:7450",
)
@click.option(
    "--listen",
    metavar="ENDPOINT",
    multiple=True,
    help="Listen there; may be repeated. Default: tcp/127.0.0.1:7447, which only this machine reaches. "
    "All networks: tcp/[::]:7447.",
)
@click.option(
    "--connect", metavar="ENDPOINT", multiple=True, help="Connect to the router there; may be repeated."
)
@click.option(
    "--config",
    metavar="FILE",
    type=EXISTING_FILE,
    help="Zenoh's own configuration, for TLS and access control. Default: the file in "
    "ZENOH_ROUTER_CONFIG_URI, if that is set.",
)
def router(listen: tuple[str, ...], connect: tuple[str, ...], config: Path | None) -> int:
    """Run a Zenoh router, until Ctrl-C.

    Programs on several machines meet there: those on our local transport with ROS_STATIC_PEERS=HOST, and
    those of ROS 2 with rmw_zenoh. It takes the place of rmw_zenohd. An ENDPOINT is tcp/HOST:PORT or
    tls/HOST:PORT.
    """
    with sigterm_raises():
        running = open_router(listen, connect, config)
        try:
            for line in _news(running):
                print(line, flush=True)
        finally:
            running.close()
    return 0


def _news(router: Router) -> Iterator[str]:
    """A line that says where it listens, then one whenever its connections change. They do not end."""
    is_private = all(map(is_on_this_machine, router.listens))
    reach = "for this machine only" if is_private else "for other machines too"
    yield f"listening on {', '.join(router.listens) or 'nothing'}, {reach}; Ctrl-C ends it"
    if router.listens == (DEFAULT_ENDPOINT,):
        yield "`ifgen router --listen tcp/[::]:7447` lets other machines in"
    names, expected = ", ".join(router.connects), len(router.connects)
    before = None
    while True:
        time.sleep(_LOOK_EVERY)
        connected = router.connected() if expected else None
        if connected is None or connected == before:
            continue
        before = connected
        if connected >= expected:
            yield f"connected to {names}"
        else:
            yield f"connected to {connected} of {terminal.counted(expected, 'router')}, still trying: {names}"


class Router:
    """A router that runs until `close`."""

    def __init__(self, session: zenoh.Session, listens: Sequence[str], connects: Sequence[str]) -> None:
        self.listens: Final = tuple(listens)
        """The endpoints that it listens on."""
        self.connects: Final = tuple(connects)
        """The endpoints that it is to be connected to."""
        self._session = session

    def close(self) -> None:
        """End it. Programs go on, and look for it until it is back."""
        self._session.close()  # type: ignore[no-untyped-call]  # its stub has no return type

    def connected(self) -> int:
        """Return how many of `connects` it is connected to."""
        ports = {_protocol_and_port(endpoint) for endpoint in self.connects}
        links = {link.dst for link in self._session.info.links()}  # who connects to it has another port
        return sum(_protocol_and_port(link) in ports for link in links)


def open_router(
    listen: Sequence[str] = (),
    connect: Sequence[str] = (),
    file: Path | None = None,
    variables: Mapping[str, str] = os.environ,
) -> Router:
    """Start a router; `file` is a configuration of Zenoh.

    Raises UsageError for a wrong endpoint or configuration and where Zenoh is missing, InputError where it
    cannot listen, and OSError for a file that cannot be read.
    """
    for endpoint in (*listen, *connect):
        check_endpoint(endpoint)
    try:
        import zenoh
    except ModuleNotFoundError:
        advice = f"run `{installing.add_runtime()}`"
        raise UsageError([Diagnostic("no-zenoh", "a router needs Zenoh", help=advice)]) from None
    config = configuration(listen, connect, file, variables)
    listens = endpoints_of(config, "listen")
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise _not_started(listens, reason(error)) from None
    return Router(session, listens, endpoints_of(config, "connect"))


def is_on_this_machine(endpoint: str) -> bool:
    """Whether no other machine can reach an endpoint."""
    return bool(_ON_THIS_MACHINE.match(endpoint))


def _not_started(listens: Sequence[str], said: str) -> InputError:
    """The error for a router that does not start: because of the machine, or of its configuration."""
    named = [each for each in listens if _address(each) in said]
    what = f"a router cannot listen on {', '.join(named or listens)}"
    if number := _SYSTEM_ERROR.search(said):
        code = int(number[1])
        message = f"{what}: {os.strerror(code).lower()}"
        return InputError([Diagnostic("no-router", message, help=_ADVICE.get(code, _ANYWHERE))])
    if "lookup address" in said:
        return InputError([Diagnostic("no-router", f"{what}: {said}", help=_ANYWHERE)])
    said = said.rpartition(" TLS listener on ")[2].partition(". ")[2] or said  # which `what` says already
    message = f"{what if named else 'a router cannot start'}: {said}"
    return UsageError([Diagnostic("router-configuration", message)])


def _address(endpoint: str) -> str:
    return re.split(r"[?#]", endpoint.partition("/")[2])[0]


def _protocol_and_port(endpoint: str) -> tuple[str, str]:
    return endpoint.partition("/")[0], _address(endpoint).rpartition(":")[2]
