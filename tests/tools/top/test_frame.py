"""What the screen shows, as text."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from ifgen_tools.top.screen.frame import frame, tables
from ifgen_tools.top.screen.view import View
from ifgen_tools.top.snapshot import Parameters, Snapshot
from rich.console import Console

from tests.tools.top.samples import ROBOT

PICTURES = Path(__file__).parent / "pictures"


def shown(view: View, width: int = 80, height: int = 12, snapshot: Snapshot | None = ROBOT) -> str:
    """The screen without its clock."""
    text = frame(snapshot, view, width, height).plain
    lines = text.split("\n")
    assert [len(line) for line in lines] == [width] * height
    return "\n".join(line.rstrip() for line in text.replace(_clock(text), "12:00:00").split("\n")) + "\n"


def _clock(text: str) -> str:
    title = text.split("\n", maxsplit=1)[0].split("  ")
    return title[0].rpartition(" ")[2] if len(title) > 1 and ":" in title[0] else "\0"


@pytest.mark.parametrize("table", ["topics", "nodes", "subscriptions", "executors"])
def test_tables_at_80_columns(table: str) -> None:
    assert shown(View(table)) == (PICTURES / f"{table}.txt").read_text()


def test_all_tables_for_a_pipe() -> None:
    assert tables(ROBOT, 100).plain + "\n" == (PICTURES / "once.txt").read_text()


def test_a_system_whose_processes_say_nothing_of_themselves() -> None:
    real = Snapshot(0.0, "rclpy", ROBOT.nodes[2:], ROBOT.topics[:1])
    text = shown(View("executors"), snapshot=real)
    assert "on real rclpy" in text
    assert "no executors: only processes of the local transport tell of theirs" in text
    assert "no topics" in shown(View(), snapshot=Snapshot(0.0, "local"))
    assert "looking for nodes" in shown(View(), snapshot=None)


@pytest.mark.parametrize("size", [(1, 1), (7, 2), (20, 3), (80, 4), (81, 5), (300, 70)])
def test_any_size_of_terminal(size: tuple[int, int]) -> None:
    for view in (View(), View("executors"), View(is_help=True), View(parameters_of="/arm")):
        shown(view, *size)


def test_what_is_marked_is_also_seen_without_colour() -> None:
    output = StringIO()
    console = Console(file=output, force_terminal=True, no_color=True, width=80, legacy_windows=False)
    console.print(frame(ROBOT, View(), 80, 8))
    marked = [line for line in output.getvalue().split("\n") if "\x1b[7m" in line or "\x1b[1;7m" in line]
    assert ["/arm/very" in line for line in marked] == [True]


def test_parameters() -> None:
    view = View("nodes", parameters_of="/arm")
    assert "asking ..." in shown(view)
    view.parameters = Parameters("/arm", (("gain", "0.1"), ("a_longer_name", "[1, 2]")))
    assert "gain           0.1\na_longer_name  [1, 2]\n" in shown(view)
    view.parameters = Parameters("/arm", problem="it does not answer")
    assert "it does not answer" in shown(view)
    view.parameters = Parameters("/arm")
    assert "it has none" in shown(view)


def test_a_filter_that_nothing_passes() -> None:
    assert "nothing has 'walk' in it" in shown(View(filter="walk"))
