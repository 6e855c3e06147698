"""`ifgen top`: which of its views it is."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from ifgen.signals import Terminated

from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from ifgen_tools.top.gathering import Gatherer

# Late imports: only one of the views runs, and the page needs no rich.

_WIDTH = 120
"""Characters of a line where there is no terminal that says."""


def run(
    *,
    transport: Literal["local", "rclpy", "auto"],
    once: bool,
    as_json: bool,
    web: bool,
    port: int,
    period: float,
    view: str,
    include_hidden: bool,
    no_subscribe: bool,
) -> int:
    """Watch; returns the exit code."""
    from ifgen_tools.top.gathering import Gatherer

    with open_session(transport) as session:
        is_screen = not (web or as_json or once) and _has_terminal()
        notes: list[str] = []
        if is_screen:
            session.lookout.say = notes.append
        gatherer = Gatherer(session, include_hidden=include_hidden, listens=not no_subscribe)
        session.discover()
        if web:
            from ifgen_tools.top.web.page import serve

            return _until_interrupted(lambda: serve(gatherer, port, period))
        if as_json:
            return _print_json(gatherer, period, once=once)
        if not is_screen:
            return _print_tables(gatherer, period)
        from ifgen_tools.top.screen.live import watch

        return _until_interrupted(lambda: watch(gatherer, period, view, notes))


def _until_interrupted(show: Callable[[], None]) -> int:
    """Show something that Ctrl-C ends, as it is meant to; returns the exit code."""
    try:
        show()
    except KeyboardInterrupt as stop:
        if isinstance(stop, Terminated):
            raise
    return 0


def _has_terminal() -> bool:
    return sys.stdin.isatty() and sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb"


def _print_json(gatherer: Gatherer, period: float, *, once: bool) -> int:
    """One line for each look, or for the first with rates."""
    from ifgen_tools.top.snapshot import as_json

    gatherer.want(each.name for each in gatherer.step().topics)
    gatherer.step()
    while True:
        gatherer.spin(period)
        snapshot = gatherer.step()
        print(json.dumps(as_json(snapshot), allow_nan=False), flush=True)
        if once:
            return 0
        gatherer.want(each.name for each in snapshot.topics)


def _print_tables(gatherer: Gatherer, period: float) -> int:
    from rich.console import Console

    from ifgen_tools.top.screen.frame import tables

    gatherer.want(each.name for each in gatherer.step().topics)
    gatherer.step()
    gatherer.spin(period)
    snapshot = gatherer.step()
    console = Console(file=sys.stdout, highlight=False, markup=False)
    width = console.width if sys.stdout.isatty() or os.environ.get("COLUMNS") else _WIDTH
    console.print(tables(snapshot, width), soft_wrap=True)
    return 0
