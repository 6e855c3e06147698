"""What keys do."""

from __future__ import annotations

from dataclasses import replace

import pytest
from ifgen_tools.top.screen.tables import amount, duration, shortened
from ifgen_tools.top.screen.terminal import keys
from ifgen_tools.top.screen.view import View
from ifgen_tools.top.snapshot import Snapshot, TopicRow

from tests.tools.top.samples import ROBOT

MANY = Snapshot(0.0, "local", topics=tuple(TopicRow(f"/t{number:02}") for number in range(30)))


def after(*pressed: str, view: View | None = None, snapshot: Snapshot = ROBOT) -> View:
    """The view after these keys."""
    view = view or View(page=5)
    for key in pressed:
        view.press(key, snapshot)
    return view


def names(view: View, snapshot: Snapshot = ROBOT) -> list[str]:
    """The rows of the table."""
    return [view.table.identity(row) for row in view.rows(snapshot)]


def on_screen(view: View, snapshot: Snapshot) -> list[str]:
    rows = view.rows(snapshot)
    view.settle(rows)
    return [row.name for row in view.on_screen(rows)]


def test_tables() -> None:
    assert [after(*["tab"] * number).table_name for number in range(5)] == [
        "topics",
        "nodes",
        "subscriptions",
        "executors",
        "topics",
    ]
    assert after("backtab").table_name == after("4").table_name == "executors"


def test_numbers_sort_from_the_largest_and_unknown_ones_last() -> None:
    assert names(View())[0].startswith("/arm")
    by_rate = after("right", "right", "s")
    assert names(by_rate) == [ROBOT.topics[1].name, ROBOT.topics[0].name, "/quiet"]
    upwards = names(by_rate)[::-1]
    assert names(after("s", view=by_rate)) == upwards
    by_bandwidth = after("right", "right", "right", "s")
    assert names(by_bandwidth) == ["/camera/image_raw", "/quiet", ROBOT.topics[1].name]
    assert names(after("s", view=by_bandwidth))[-1] == ROBOT.topics[1].name
    assert after("left").place.column == 7


def test_the_mark_scrolls_and_stays_with_its_row() -> None:
    view = after(*["down"] * 6, snapshot=MANY)
    assert on_screen(view, MANY) == ["/t02", "/t03", "/t04", "/t05", "/t06"]
    assert view.place.chosen == "/t06"
    fewer = replace(MANY, topics=MANY.topics[3:])
    assert "/t06" in on_screen(view, fewer)
    assert view.place.chosen == "/t06"
    gone = replace(MANY, topics=MANY.topics[:2])
    assert on_screen(view, gone) == ["/t00", "/t01"]
    assert view.place.chosen == "/t01"
    assert after("end", snapshot=MANY).place.chosen == "/t29"
    assert after("end", "page up", "up", snapshot=MANY).place.chosen == "/t23"
    assert after("end", "home", snapshot=MANY).place.chosen is None  # the first one, whichever that is
    assert after("down", snapshot=Snapshot(0.0, "local")).place.chosen is None


def test_the_first_rows_are_shown_until_somebody_moves_the_mark() -> None:
    view = after("right", "right", "s", snapshot=MANY)
    assert on_screen(view, MANY)[0] == "/t00"
    rates = [replace(each, rate=float(number)) for number, each in enumerate(MANY.topics)]
    assert on_screen(view, replace(MANY, topics=tuple(rates)))[0] == "/t29"
    assert on_screen(after("end", "s", view=view, snapshot=MANY), MANY)[0] == "/t00"


def test_filter() -> None:
    view = after("/", *"IMAGE", "x", "backspace", "enter")
    assert names(view) == ["/camera/image_raw"]
    assert names(after("escape", view=view)) == names(View())
    assert after("/", "q").filter == "q"  # which does not quit
    assert after("/", "q", "escape").filter == ""


def test_parameters_help_and_the_end() -> None:
    view = after("2", "p")
    assert view.parameters_of == "/arm/controller"
    assert after("escape", view=view).parameters_of is None
    assert after("p", snapshot=Snapshot(0.0, "local")).parameters_of is None
    assert after("?").is_help
    assert not after("?", "x").is_help
    assert after("q").is_over
    assert after("2", "p", "q").is_over


@pytest.mark.parametrize(
    ("sent", "expected"),
    [
        (b"\x1b[A\x1b[B\x1bOC\x1b[D", ["up", "down", "right", "left"]),
        (b"\x1b[5~\x1b[6~\x1b[H\x1b[4~\x1b[Z\t", ["page up", "page down", "home", "end", "backtab", "tab"]),
        (b"\x1b", ["escape"]),
        (b"a\r\x7f\x04/", ["a", "enter", "backspace", "q", "/"]),
        ("ä".encode(), ["ä"]),
        (b"\x1b[1;5A\x1b[200~\x00\xff", ["\ufffd"]),  # what means nothing
    ],
)
def test_keys(sent: bytes, expected: list[str]) -> None:
    assert keys(sent) == expected


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "-"),
        (0, "0"),
        (0.1, "0.10"),
        (12.34, "12.3"),
        (99.96, "100"),
        (999.6, "1.00k"),
        (27.6e6, "27.6M"),
    ],
)
def test_amounts(value: float | None, text: str) -> None:
    assert amount(value) == text


def test_durations() -> None:
    assert [duration(each) for each in (0, 0.00085, 0.0123, 1.5)] == ["-", "850us", "12.3ms", "1.50s"]


def test_long_names_keep_their_ends() -> None:
    assert shortened("/arm/very_long_name/joint_states", 16) == "/arm/~int_states"
    assert [len(shortened("a" * 50, width)) for width in range(6)] == list(range(6))
