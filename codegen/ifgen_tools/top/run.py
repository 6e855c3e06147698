"""`ifgen top`: which of its views it is."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

from ifgen.signals import Terminated

from ifgen_tools.session import open_session

if TYPE_CHECKING:
    from ifgen_tools.top.collector import Collector
    from ifgen_tools.top.commands import TopOptions

# Late imports: only one of the views runs, and the page needs no rich.

_WIDTH = 120
"""Characters of a line where there is no terminal that says."""


def run(chosen: TopOptions) -> int:
    """Watch; returns the exit code."""
    from ifgen_tools.top.collector import Collector

    with open_session(chosen.transport) as session:
        is_screen = not (chosen.web or chosen.as_json or chosen.once) and _has_terminal()
        notes: list[str] = []
        if is_screen:
            session.lookout.say = notes.append
        collector = Collector(session, include_hidden=chosen.include_hidden, listens=not chosen.no_subscribe)
        session.discover()
        if chosen.web:
            from ifgen_tools.top.web.page import serve

            return _until_interrupted(lambda: serve(collector, chosen.port, chosen.period))
        if chosen.as_json:
            return _print_json(collector, chosen.period, once=chosen.once)
        if not is_screen:
            return _print_tables(collector, chosen.period)
        from ifgen_tools.top.screen.live import watch

        return _until_interrupted(lambda: watch(collector, chosen.period, chosen.view, notes))


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


def _print_json(collector: Collector, period: float, *, once: bool) -> int:
    """One line for each look, or for the first with rates."""
    from ifgen_tools.top.snapshot import as_json

    collector.want(each.name for each in collector.step().topics)
    collector.step()
    while True:
        collector.spin(period)
        snapshot = collector.step()
        print(json.dumps(as_json(snapshot), allow_nan=False), flush=True)
        if once:
            return 0
        collector.want(each.name for each in snapshot.topics)


def _print_tables(collector: Collector, period: float) -> int:
    from rich.console import Console

    from ifgen_tools.top.screen.frame import tables

    collector.want(each.name for each in collector.step().topics)
    collector.step()
    collector.spin(period)
    snapshot = collector.step()
    console = Console(file=sys.stdout, highlight=False, markup=False)
    width = console.width if sys.stdout.isatty() or os.environ.get("COLUMNS") else _WIDTH
    console.print(tables(snapshot, width), soft_wrap=True)
    return 0
