"""`make interop`: exchanges with other implementations of the conventions of rmw_zenoh, as a table."""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final

import click

from tests.interop.bench.environments import CannotInstall
from tests.interop.bench.environments import install as install_peer
from tests.interop.bench.matrix import Matrix
from tests.interop.bench.outcomes import Cell, Feature, Outcome, Row
from tests.interop.bench.peers import PEERS

_FEATURES: Final = {
    "topic": "topic",
    "service": "service",
    "action": "action",
    "parameter": "param",
    "graph": "graph",
    "transient local": "kept",
    "large image": "image",
    "Lyrical's buffer keys": "buffer",
}
"""The column of each feature."""
_PEERS: Final = tuple(peer.name for peer in PEERS)
_LINE: Final = 80
_LONGEST: Final = 5  # of the words in the table
_NOTES: Final = (
    "ok: both directions, each field. part, -: not all of it, none of it; see below.",
    "FAILS: it should work. kept: transient local. image: 0.9 and 6.2 MB. buffer:",
    "Lyrical's keys for images; its publisher is simulated.",
    "No rmw_zenoh_cpp was run: no wheel of it exists.",
)


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: python -m tests.interop.bench --peer pyzeros --feature topic",
)
@click.option(
    "--peer",
    "names",
    metavar="NAME",
    multiple=True,
    type=click.Choice(_PEERS, case_sensitive=False),
    help=f"Only this one; may be repeated: {', '.join(_PEERS)}.",
)
@click.option(
    "--feature",
    "columns",
    metavar="NAME",
    multiple=True,
    type=click.Choice(list(_FEATURES.values())),
    help=f"Only this one; may be repeated: {', '.join(_FEATURES.values())}.",
)
@click.option(
    "--python",
    "pythons",
    metavar="NAME=PATH",
    multiple=True,
    help="The interpreter that has this peer; may be repeated. Default: what --install made, or this one.",
)
@click.option("--install", is_flag=True, help="First install each peer by pip, in an environment of its own.")
@click.option(
    "--format",
    "format_",
    type=click.Choice(["text", "json"]),
    default="text",
    help="For people (text) or tools (json).",
)
def interop(
    names: tuple[str, ...], columns: tuple[str, ...], pythons: tuple[str, ...], install: bool, format_: str
) -> None:
    """Exchange messages with others that speak like rmw_zenoh, or DDS.

    One side is a node on our local transport, the other a small program on the public API of dora-rs,
    zenoh-ros2-sdk, pyzeros, or pamoja-ros2, and real rclpy on DDS (Jazzy, Kilted) behind a bridge of dora-rs.
    Cyclone DDS meets our classes on real rclpy.
    A router on a free port of this machine is between them. Exits with 1 if something fails that should work,
    or works that is listed as failing. What is not installed does not fail.
    """
    chosen = [peer for peer in PEERS if not names or peer.name in names]
    features = [feature for feature in Feature if not columns or _FEATURES[feature] in columns]
    try:
        for peer in chosen if install else ():
            _report(f"installing {peer.name}")
            install_peer(peer)
    except CannotInstall as error:
        raise click.ClickException(str(error)) from None
    with Matrix(_by_name(pythons), _report) as matrix:
        rows = list(matrix.rows(chosen, features))
    if format_ == "json":
        print(json.dumps([asdict(row) for row in rows], indent=2))
    else:
        print("\n".join(lines(rows)))
    sys.exit(int(any(cell.word == "FAILS" for row in rows for cell in row.cells)))


def lines(rows: Sequence[Row]) -> Iterable[str]:
    """The table, at most 80 columns wide, then a note for each cell that is not full."""
    names = [_title(row) for row in rows]
    width = max(map(len, names), default=0)
    columns = [_FEATURES[cell.feature] for cell in rows[0].cells] if rows else []
    yield _line("", columns, columns, width)
    for row, name in zip(rows, names, strict=True):
        yield _line(name, columns, [cell.word for cell in row.cells], width)
    yield ""
    yield from _NOTES
    for row in rows:
        yield from _reasons(row)
    absent = [row.peer for row in rows if _is_absent(row)]
    if absent:
        yield ""
        yield textwrap.fill(f"Not installed, or too old: {', '.join(absent)}.", _LINE)
        yield "`make interop INSTALL=1` makes an environment for each, of about 1 GB in all."


def _is_absent(row: Row) -> bool:
    return any(check.outcome is Outcome.ABSENT for cell in row.cells for check in cell.checks)


def _line(name: str, columns: Sequence[str], words: Sequence[str], width: int) -> str:
    cells = zip(columns, words, strict=True)
    return f"{name:{width}}" + "".join(f" {word:>{max(len(column), _LONGEST)}}" for column, word in cells)


def _title(row: Row) -> str:
    version = next(iter(row.versions.values()), "")
    return f"{row.peer} {version}".strip()


def _reasons(row: Row) -> Iterable[str]:
    """Why cells are not full, those with one reason together."""
    by_reason: dict[str, list[str]] = {}
    for cell in row.cells:
        for check in cell.checks:
            if check.reason:
                by_reason.setdefault(check.reason, []).append(_place(cell, check.name))
    if by_reason:
        yield ""
        yield f"{row.peer}:"
    for reason, places in by_reason.items():
        whole = f"{', '.join(dict.fromkeys(places))}: {reason}"
        yield textwrap.fill(whole, _LINE, initial_indent="  ", subsequent_indent="    ")


def _place(cell: Cell, check: str) -> str:
    column = _FEATURES[cell.feature]
    return f"{column} ({check})" if check else column


def _by_name(pythons: Iterable[str]) -> dict[str, str]:
    """The interpreters by peer. Raises UsageError for what is none."""
    found: dict[str, str] = {}
    for each in pythons:
        name, _, path = each.partition("=")
        peer = next((known for known in _PEERS if known.lower() == name.lower()), None)
        if peer is None or not Path(path).is_file():
            message = f"--python {each}: expected one of {', '.join(_PEERS)}, `=`, and a Python interpreter"
            raise click.UsageError(message, click.get_current_context())
        found[peer] = path
    return found


def _report(line: str) -> None:
    if sys.stderr.isatty():
        print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    interop()
