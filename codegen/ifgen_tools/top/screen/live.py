"""The view that stays: a thread gathers, this one draws and listens to keys."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from ifgen_tools.top.gathering import Gatherer
from ifgen_tools.top.parameters import Parameters
from ifgen_tools.top.screen.frame import frame
from ifgen_tools.top.screen.keys import keys
from ifgen_tools.top.screen.terminal import Terminal, taken
from ifgen_tools.top.screen.view import View
from ifgen_tools.top.snapshot import Snapshot

_TURN: Final = 0.1  # [s] for which the gathering thread does not look whether there is something to do
_PATIENCE: Final = 3.0  # [s] for that thread to end


class Gathering:
    """Gathers on a thread of its own."""

    def __init__(self, gatherer: Gatherer, period: float, tell: Callable[[], None]) -> None:
        self.snapshot: Snapshot | None = None
        self.parameters: Parameters | None = None
        self.failure: BaseException | None = None
        self._gatherer = gatherer
        self._period = period
        self._tell = tell
        self._asked: str | None = None
        self._is_over = False
        self._thread = threading.Thread(target=self._run, name="gathering", daemon=True)
        self._thread.start()

    def ask_for_parameters(self, node: str) -> None:
        """Read the parameters of a node next."""
        self.parameters = None
        self._asked = node

    def end(self) -> None:
        """Stop, and wait until it has."""
        self._is_over = True
        self._thread.join(_PATIENCE)

    def _run(self) -> None:
        try:
            while not self._is_over:
                self.snapshot = self._gatherer.step()
                self._tell()
                self._spin()
            self._gatherer.close()
        except BaseException as error:  # the thread that draws raises it
            self.failure = error
            self._tell()

    def _spin(self) -> None:
        left = self._period
        while left > 0 and not self._is_over:
            if self._asked is not None:
                node, self._asked = self._asked, None
                self.parameters = self._gatherer.parameters(node)
                self._tell()
            self._gatherer.spin(min(_TURN, left))
            left -= _TURN


def watch(gatherer: Gatherer, period: float, table: str, notes: list[str]) -> None:
    """Show the view until somebody quits; `notes`, which may come later, as long as there are no nodes."""
    view = View(table, notes=notes)
    with taken() as terminal:
        gathering = Gathering(gatherer, period, terminal.wake)
        try:
            _loop(terminal, view, gathering, gatherer)
        finally:
            gathering.end()


def _loop(terminal: Terminal, view: View, gathering: Gathering, gatherer: Gatherer) -> None:
    while not view.is_over:
        if gathering.failure is not None:
            raise gathering.failure
        snapshot = gathering.snapshot
        found = gathering.parameters
        if found is not None and found.node == view.parameters_of:
            view.parameters = found
        terminal.show(frame(snapshot, view, *terminal.size))
        if snapshot is not None and view.table_name == "topics":
            gatherer.want(row.name for row in view.on_screen(view.rows(snapshot)))
        else:
            gatherer.want(())
        try:
            pressed = keys(terminal.wait(3600))
        except EOFError:
            return
        for key in pressed:
            before = view.parameters_of
            view.press(key, snapshot or Snapshot(0.0, ""))
            if view.parameters_of is not None and view.parameters_of != before:
                gathering.ask_for_parameters(view.parameters_of)
