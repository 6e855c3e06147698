"""The user's choice of what to see, and the keys that change it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

from ifgen_tools.top.parameters import Parameters
from ifgen_tools.top.screen.tables import TABLES, Table, ordered
from ifgen_tools.top.snapshot import Snapshot

FRAME: Final = 4
"""Lines that are not rows: title, tables, columns and keys."""
_LONGEST_FILTER: Final = 60
_END: Final = 1_000_000
_STEPS: Final = {"up": -1, "k": -1, "down": 1, "j": 1, "home": -_END, "end": _END}
_PAGES: Final = {"page up": -1, "page down": 1}


@dataclass(slots=True)
class Place:
    """The state of each table."""

    column: int = 0
    sorted_by: int = 0
    is_reversed: bool = False
    index: int = 0
    chosen: str | None = None
    """The identity of the row that is marked; None for the first one, whichever that is."""
    first: int = 0
    """The first row on the screen."""


@dataclass(slots=True)
class View:
    """The state of the screen. `page` is the number of rows that it shows."""

    table_name: str = "topics"
    page: int = 20
    filter: str = ""
    is_filtering: bool = False
    is_help: bool = False
    is_over: bool = False
    parameters_of: str | None = None
    """The node whose parameters are shown."""
    parameters: Parameters | None = None
    """Those that have been read; None while they are awaited."""
    scrolled: int = 0
    """The first parameter on the screen."""
    notes: list[str] = field(default_factory=list[str])
    """The text that is shown as long as there are no nodes."""
    places: dict[str, Place] = field(default_factory=lambda: {name: Place() for name in TABLES})

    @property
    def table(self) -> Table:
        """The table that is shown."""
        return TABLES[self.table_name]

    @property
    def place(self) -> Place:
        """The state of the table that is shown."""
        return self.places[self.table_name]

    def rows(self, snapshot: Snapshot) -> list[Any]:
        """The rows that pass the filter, in order."""
        wanted = self.filter.lower()
        rows = [
            row
            for row in self.table.rows(snapshot)
            if not wanted or any(wanted in column.text(row).lower() for column in self.table.columns)
        ]
        return ordered(self.table, rows, self.place.sorted_by, is_reversed=self.place.is_reversed)

    def settle(self, rows: list[Any]) -> None:
        """Follow the marked row to where it is now, and keep it on the screen."""
        place = self.place
        names = [self.table.identity(row) for row in rows]
        if place.chosen is None:
            place.index = 0
        elif not 0 <= place.index < len(names) or names[place.index] != place.chosen:
            place.index = (
                names.index(place.chosen)
                if place.chosen in names
                else max(min(place.index, len(names) - 1), 0)
            )
        if place.chosen is not None:
            place.chosen = names[place.index] if names else None
        last = max(len(names) - self.page, 0)
        place.first = max(min(place.first, place.index, last), place.index - self.page + 1, 0)

    def on_screen(self, rows: list[Any]) -> list[Any]:
        """The rows on the screen."""
        return rows[self.place.first : self.place.first + self.page]

    def press(self, key: str, snapshot: Snapshot) -> None:
        """Do what a key means now."""
        if self.is_filtering:
            self._press_filtering(key)
        elif key == "q":
            self.is_over = True
        elif self.is_help:
            self.is_help = False
        elif self.parameters_of is not None:
            self._press_parameters(key)
        else:
            self._press(key, snapshot)

    def _press(self, key: str, snapshot: Snapshot) -> None:
        place, names = self.place, list(TABLES)
        columns = len(self.table.columns)
        rows = self.rows(snapshot)
        self.settle(rows)
        if (step := self._step(key)) is not None:
            self._move(step, rows)
        elif key in {"tab", "backtab"}:
            way = 1 if key == "tab" else -1
            self.table_name = names[(names.index(self.table_name) + way) % len(names)]
        elif key.isdigit() and 0 < int(key) <= len(names):
            self.table_name = names[int(key) - 1]
        elif key in {"left", "right"}:
            place.column = (place.column + (1 if key == "right" else -1)) % columns
        elif key == "s":
            place.is_reversed = place.sorted_by == place.column and not place.is_reversed
            place.sorted_by = place.column
            place.chosen = None
        elif key == "/":
            self.is_filtering = True
        elif key == "escape":
            self.filter = ""
        elif key in {"?", "h"}:
            self.is_help = True
        elif key in {"p", "enter"}:
            self._ask_for_parameters(rows)

    def _step(self, key: str) -> int | None:
        """How many rows a key goes down; None if it does not move."""
        return _PAGES[key] * self.page if key in _PAGES else _STEPS.get(key)

    def _move(self, step: int, rows: list[Any]) -> None:
        place = self.place
        place.index = max(min(place.index + step, len(rows) - 1), 0)
        place.chosen = self.table.identity(rows[place.index]) if place.index else None
        self.settle(rows)

    def _ask_for_parameters(self, rows: list[Any]) -> None:
        nodes = self.table.nodes(rows[self.place.index]) if rows else ()
        if nodes:
            self.parameters_of, self.parameters, self.scrolled = nodes[0], None, 0

    def _press_filtering(self, key: str) -> None:
        if key in {"enter", "escape"}:
            self.is_filtering = False
            self.filter = "" if key == "escape" else self.filter
        elif key == "backspace":
            self.filter = self.filter[:-1]
        elif len(key) == 1 and len(self.filter) < _LONGEST_FILTER:
            self.filter += key

    def _press_parameters(self, key: str) -> None:
        if key in {"escape", "p", "enter", "backspace"}:
            self.parameters_of = self.parameters = None
        elif (step := self._step(key)) is not None and self.parameters is not None:
            last = max(len(self.parameters.values) - self.page, 0)
            self.scrolled = max(min(self.scrolled + step, last), 0)
