"""`ifgen router`: a Zenoh router for programs on several machines."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.cli import terminal
from ifgen.cli.arguments import EXISTING_FILE
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.running.router import Router

# Late imports: --help needs none of the router.

_LOOK_EVERY = 1.0  # [s], for the routers that this one is to be connected to


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
    from ifgen.running.router import open_router

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
    from ifgen.running.router import is_on_this_machine
    from ifgen.running.router_configuration import DEFAULT_ENDPOINT

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
