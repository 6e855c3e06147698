"""What the demo says on the terminal: a line of progress, and a summary."""

from __future__ import annotations

import shutil
import sys
import textwrap
import time

from ..data import Mode
from .director import Director, Score

_LINE = 0.1  # s between changes of the progress line


class ProgressLine:
    """One line on a terminal that is overwritten; nothing in a pipe.

    The cursor stays at its beginning, so that log lines of nodes overwrite it too.
    """

    def __init__(self) -> None:
        self._shown = 0.0
        self._open = False

    def show(self, director: Director, started: float) -> None:
        """Show what the robot does; `started` is when that began [s of real time]."""
        now = time.monotonic()
        if not sys.stdout.isatty() or now - self._shown < _LINE:
            return
        self._shown = now
        if director.mode is Mode.UNKNOWN:
            text = "waiting for the nodes"
        else:
            mode = director.mode.name.lower().replace("_", " ")
            speed = (director.now - (director.begun or 0.0)) / max(now - started, 1e-3)
            text = f"{director.now:7.2f} s  {mode}, {director.score.steps} steps, {speed:.1f}x real time"
        self._print(text)

    def draws(self, number: int, total: int) -> None:
        """Show how many pictures are drawn; a pipe hears once that it takes a while."""
        if not sys.stdout.isatty():
            if number == 1:
                print(f"drawing {total} pictures", flush=True)
            return
        self._print(f"drawing picture {number} of {total}")
        if number == total:
            self.clear()

    def _print(self, text: str) -> None:
        self._open = True
        width = shutil.get_terminal_size().columns - 1
        print(f"\r\x1b[K{text[:width]}\r", end="", flush=True)

    def clear(self) -> None:
        """Remove it."""
        if self._open:
            print("\r\x1b[K", end="", flush=True)
            self._open = False


def summary(scenario: str, outcome: str, simulated: float, real: float, score: Score) -> dict[str, str]:
    """The rows of the summary; times in seconds, no time without a factor."""
    rows = {
        "scenario": scenario,
        "outcome": outcome,
        "simulated": f"{simulated:.1f} s",
        "real-time factor": f"{simulated / real:.2f}" if real else "",
        "steps": str(score.steps),
        "distance": f"{score.distance:.2f} m",
        "speed": f"{score.speed:.2f} m/s walking" if score.walking else "",
    }
    rows = {name: value for name, value in rows.items() if value}
    if score.foot_errors:
        rows["foot error"] = f"{score.foot_error * 1e3:.1f} mm rms"
    if score.goal_errors:
        rows["goal error"] = f"{max(score.goal_errors) * 1e3:.0f} mm at most"
    if score.dances:
        rows["dances"] = str(score.dances)
    if score.pushes:
        rows["pushes"] = str(score.pushes)
    if score.stop_times:
        rows["stop after cancel"] = f"{max(score.stop_times):.2f} s at most"
    if score.obstacles:
        rows["touches"] = f"{score.touches} (obstacles: {score.obstacles})"
    rows["falls"] = str(score.falls)
    return rows


def show(rows: dict[str, str]) -> None:
    """Print rows, their values below each other, in the width of the terminal."""
    width = max(map(len, rows))
    room = max(shutil.get_terminal_size().columns - width - 5, 20)
    print()
    for name, value in rows.items():
        first, *others = textwrap.wrap(value, room) or [""]
        print(f"  {name:{width}}  {first}")
        for line in others:
            print(f"  {'':{width}}  {line}")
