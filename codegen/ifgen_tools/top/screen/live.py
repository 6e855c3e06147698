"""The view that stays: a thread collects, this one draws and listens to keys."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from ifgen_tools.top.collector import Collector
from ifgen_tools.top.screen.frame import frame
from ifgen_tools.top.screen.terminal import Terminal, keys, taken
from ifgen_tools.top.screen.view import View
from ifgen_tools.top.snapshot import Parameters, Snapshot

_TURN: Final = 0.1  # [s] for which the collecting thread does not look whether there is something to do
_PATIENCE: Final = 3.0  # [s] for that thread to end


class _Background:
    """A collector on a thread of its own."""

    def __init__(self, collector: Collector, period: float, tell: Callable[[], None]) -> None:
        self.snapshot: Snapshot | None = None
        self.parameters: Parameters | None = None
        self.failure: BaseException | None = None
        self._collector = collector
        self._period = period
        self._tell = tell
        self._asked: str | None = None
        self._is_over = False
        self._thread = threading.Thread(target=self._run, name="collector", daemon=True)
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
                self.snapshot = self._collector.step()
                self._tell()
                self._spin()
            self._collector.close()
        except BaseException as error:  # the thread that draws raises it
            self.failure = error
            self._tell()

    def _spin(self) -> None:
        left = self._period
        while left > 0 and not self._is_over:
            if self._asked is not None:
                node, self._asked = self._asked, None
                self.parameters = self._collector.parameters(node)
                self._tell()
            self._collector.spin(min(_TURN, left))
            left -= _TURN


def watch(collector: Collector, period: float, table: str, notes: list[str]) -> None:
    """Show the view until somebody quits; `notes`, which may come later, as long as there are no nodes."""
    view = View(table, notes=notes)
    with taken() as terminal:
        background = _Background(collector, period, terminal.wake)
        try:
            _loop(terminal, view, background, collector)
        finally:
            background.end()


def _loop(terminal: Terminal, view: View, background: _Background, collector: Collector) -> None:
    while not view.is_over:
        if background.failure is not None:
            raise background.failure
        snapshot = background.snapshot
        found = background.parameters
        if found is not None and found.node == view.parameters_of:
            view.parameters = found
        terminal.show(frame(snapshot, view, *terminal.size))
        if snapshot is not None and view.table_name == "topics":
            collector.want(row.name for row in view.on_screen(view.rows(snapshot)))
        else:
            collector.want(())
        try:
            pressed = keys(terminal.wait(3600))
        except EOFError:
            return
        for key in pressed:
            before = view.parameters_of
            view.press(key, snapshot or Snapshot(0.0, ""))
            if view.parameters_of is not None and view.parameters_of != before:
                background.ask_for_parameters(view.parameters_of)
