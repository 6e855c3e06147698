"""One picture of the screen: text of exactly the given number of lines and columns."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any, Final

from rich.cells import set_cell_size
from rich.text import Text

from ifgen_tools.top.screen.tables import TABLES, Column, ordered, widths
from ifgen_tools.top.screen.texts import percent, shortened
from ifgen_tools.top.screen.view import FRAME, View
from ifgen_tools.top.snapshot import Snapshot

_KEYS: Final = "tab table  arrows move  s sort  / filter  p parameters  ? help  q quit"
_BUSY: Final = 0.9
"""The load, and the part of a queue, from which it is marked."""

HELP: Final = """\
up, down, page up, page down, home, end   move
left, right     choose a column; s sorts by it, s again the other way round
tab, 1 to 4     the next table, or one of them
/               show only rows with this text; escape shows all
p, enter        the parameters of the node
q, Ctrl-C       quit

Hz     messages a second: counted by the publishers, or where they do not tell,
       by a subscription while the topic is on the screen
B/s    bytes a second, of the topics on the screen (`--no-subscribe`: of none)
DROPS  messages that subscriptions have missed: lost on the way between
       processes, or dropped by a full queue since somebody looks
QUEUE  the fullest of the subscriptions' queues
LOAD   the part of the time that an executor runs callbacks
"-"    nobody tells: real rclpy and other implementations do not know it"""


def frame(snapshot: Snapshot | None, view: View, width: int, height: int) -> Text:
    """The picture for a terminal of this size."""
    view.page = max(height - FRAME, 1)
    lines = [*_lines(snapshot, view, width)][: max(height - 1, 0)]
    lines += [Text("")] * (height - 1 - len(lines))
    lines.append(_foot(view, width))
    return Text("\n").join(_fitted(line, width) for line in lines[:height])


def tables(snapshot: Snapshot, width: int) -> Text:
    """All tables one after the other, for a pipe or a file."""
    parts: list[Text] = []
    for table in TABLES.values():
        rows = ordered(table, list(table.rows(snapshot)), 0, is_reversed=False)
        sizes = widths(table, width)
        parts.append(_row([_padded(c, c.title, size) for c, size in zip(table.columns, sizes, strict=True)]))
        parts += [_cells(table.columns, row, sizes) for row in rows]
        if not rows:
            parts.append(Text(_why_empty(snapshot, table.name)))
        parts.append(Text(""))
    for each in parts:
        each.rstrip()
    return Text("\n").join(parts[:-1])


def _lines(snapshot: Snapshot | None, view: View, width: int) -> Iterator[Text]:
    yield _title(snapshot, width)
    if view.is_help:
        yield from map(Text, HELP.splitlines())
        return
    if snapshot is None:
        return
    if view.parameters_of is not None:
        yield from _parameters(view, width)
        return
    rows = view.rows(snapshot)
    view.settle(rows)
    yield _tabs(snapshot, view, len(rows))
    place, sizes = view.place, widths(view.table, width)
    head = []
    for index, (column, size) in enumerate(zip(view.table.columns, sizes, strict=True)):
        is_down = column.is_number != place.is_reversed
        arrow = ("v" if is_down else "^") if index == place.sorted_by else ""
        title = f"{column.title}{arrow}" if len(column.title) < size else column.title
        style = "bold underline" if index == place.column else "bold"
        head.append(Text(_padded(column, title, size).plain, style))
    yield _row(head)
    for index, row in enumerate(view.on_screen(rows), place.first):
        line = _cells(view.table.columns, row, sizes)
        if index == place.index:
            line.stylize("reverse")
        yield line
    if not rows:
        yield Text(
            f"nothing has {view.filter!r} in it" if view.filter else _why_empty(snapshot, view.table_name)
        )
    if not snapshot.nodes:
        yield from map(Text, view.notes)


def _title(snapshot: Snapshot | None, width: int) -> Text:
    title = Text("ifgen top", "bold")
    if snapshot is None:
        return title.append(" - looking for nodes", "not bold")
    clock = time.strftime("%H:%M:%S", time.localtime(snapshot.at))
    text = f" - {clock}  {_many(len(snapshot.nodes), 'node')}  {_many(len(snapshot.topics), 'topic')}"
    busiest = max((each.load for each in snapshot.executors if each.load is not None), default=None)
    if busiest is not None:
        text += f"  max load {percent(busiest)}"
    if snapshot.transport != "local":
        text += "  on real rclpy"
    elif snapshot.silent:
        text += f"  {_many(len(snapshot.silent), 'node')} without figures"
    return title.append(text, "not bold")


def _tabs(snapshot: Snapshot, view: View, shown: int) -> Text:
    line = Text()
    for number, (name, table) in enumerate(TABLES.items(), 1):
        count = len(table.rows(snapshot))
        is_this = name == view.table_name
        label = f"{number} {name} {shown}/{count}" if is_this and view.filter else f"{number} {name} {count}"
        line.append(f"[{label}]" if is_this else f" {label} ", "bold" if is_this else "")
        line.append(" ")
    return line


def _foot(view: View, width: int) -> Text:
    if view.is_filtering:
        return Text(f"filter: {view.filter}_", "bold")
    if view.is_help:
        return Text("any key goes back")
    if view.parameters_of is not None:
        return Text("arrows move  escape back  q quit")
    text = f"filter: {view.filter}  escape show all  q quit" if view.filter else _KEYS
    return Text(text, "dim")


def _parameters(view: View, width: int) -> Iterator[Text]:
    yield Text(f"parameters of {view.parameters_of}", "bold")
    found = view.parameters
    if found is None:
        yield Text("asking ...")
    elif found.problem:
        yield Text(found.problem)
    elif not found.values:
        yield Text("it has none")
    else:
        longest = min(max(len(name) for name, _ in found.values), width // 2)
        for name, value in found.values[view.scrolled : view.scrolled + view.page]:
            yield Text(f"{shortened(name, longest).ljust(longest)}  {value}")


def _why_empty(snapshot: Snapshot, table: str) -> str:
    if table in {"subscriptions", "executors"} and snapshot.nodes:
        return f"no {table}: only processes of the local transport tell of theirs"
    return f"no {table}"


def _cells(columns: tuple[Column, ...], row: Any, sizes: list[int]) -> Text:
    cells = []
    for column, size in zip(columns, sizes, strict=True):
        value = column.sorts_by(row)
        cell = _padded(column, column.text(row), size)
        if column.title in {"LOAD", "QUEUE"} and isinstance(value, float) and value >= _BUSY:
            cell.stylize("bold red")
        elif column.title in {"DROPS", "DROPPED", "LOST"} and value:
            cell.stylize("bold yellow")
        cells.append(cell)
    return _row(cells)


def _row(cells: list[Text]) -> Text:
    return Text(" ").join(cells)


def _padded(column: Column, text: str, size: int) -> Text:
    text = shortened(text, size)
    return Text(text.rjust(size) if column.is_number else set_cell_size(text, size))


def _fitted(line: Text, width: int) -> Text:
    line = line.copy()
    line.truncate(width, overflow="crop", pad=True)
    return line


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
