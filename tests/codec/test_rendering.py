"""The parts of which the Python text of codecs is made."""

from __future__ import annotations

import pytest
from ifgen.generator_py.codec.body import Body, Constants
from ifgen.generator_py.codec.reads import HEADER, Piece, run_format
from ifgen.generator_py.codec.statements import (
    POSITION,
    Do,
    For,
    Move,
    Place,
    Positioned,
    product,
    without_idle_moves,
    wrapped,
)


def lines(body: Body) -> list[str]:
    return body.lines(0)


def test_what_contains_the_position_is_not_mixed_into_other_text() -> None:
    assert POSITION == "p"
    with pytest.raises(TypeError, match="'p & 7' contains the position"):
        f"table[{Positioned('p & 7')}]"


def test_known_counts_are_multiplied() -> None:
    assert product(3, 8) == 24
    assert product("n", 8) == "n * 8" and product("n", 1) == "n"


@pytest.mark.parametrize(("start", "text", "size"), [(0, "B3xI2d", 24), (3, "BI2d", 21), (4, "B3xI4x2d", 28)])
def test_runs_are_laid_out_where_they_are(start: int, text: str, size: int) -> None:
    run = [Piece("B", 1, 1, "a"), Piece("I", 4, 4, "b"), Piece("d", 8, 8, "c"), Piece("d", 8, 8, "d")]
    assert run_format(run, start) == (text, size)


def test_lengths_in_formats_are_not_added_up() -> None:
    assert run_format([HEADER, Piece("72s", 8, 72, "a"), Piece("72s", 8, 72, "b")], 0) == ("I72s72s", 144)


def test_positions_that_nothing_reads_are_not_kept() -> None:
    body = Body()
    body.place("4")
    body.move(3)
    body.move(5)
    body.assign("x", Positioned("table[p & 4]"))
    body.move("len(x)")
    with body.each("y", "z"):
        body.assign("w", "y")
        body.move(3)
    body.place("0")
    assert lines(body) == ["p = 4", "p += 8", "x = table[p & 4]", "for y in z:", "    w = y"]


def test_a_loop_reads_the_position_of_its_last_turn() -> None:
    moved, use = Move("3"), Do(Positioned("use(p)"))
    loop = For("y", "z", (use, moved))
    assert without_idle_moves([Place("4"), loop]) == (Place("4"), loop)
    idle = For("y", "z", (Place("0"), use, moved))
    assert without_idle_moves([Place("4"), idle]) == (For("y", "z", (Place("0"), use)),)


def test_statements_are_lines() -> None:
    body = Body()
    body.assign("x", "[]")
    body.refuse(["len(x) > 3", Positioned("p > 4")])
    with body.each("_", "repeat(None, 3)"), body.when("x"):
        body.do("x.append(1)")
    body.give("x")
    assert lines(body) == [
        "x = []",
        "if len(x) > 3 or p > 4:",
        "    raise TypeError",
        "for _ in repeat(None, 3):",
        "    if x:",
        "        x.append(1)",
        "return x",
    ]


def test_a_condition_with_the_position_reads_it() -> None:
    body = Body()
    body.place("4")
    body.refuse(["x", Positioned("p > len(data)")])
    body.place("8")
    assert lines(body) == ["p = 4", "if x or p > len(data):", "    raise TypeError"]


def test_a_result_that_was_just_named_is_returned_at_once() -> None:
    body = Body()
    body.assign("part1", "f(m)")
    body.give("part1")
    assert lines(body) == ["return f(m)"]


def test_constants_are_made_once() -> None:
    constants = Constants("X")
    names = [
        constants.layout("packer", "I"),
        constants.layout("packer", "d"),
        constants.layout("packer", "I"),
    ]
    assert names == ["_X_0", "_X_1", "_X_0"]
    assert constants.lines == ('_X_0 = packer("<I")', '_X_1 = packer("<d")')
    assert constants.imported == ("packer",)


def test_long_lines_are_broken_inside_brackets_only() -> None:
    arguments = ", ".join(f"argument{n}" for n in range(12))
    first, second = wrapped(f"function({arguments})", 0)
    assert first.endswith(",") and len(first) <= 104
    assert second.startswith("    argument")
    assert wrapped("a = " + " + ".join(["b" * 30] * 4), 0) == ["a = " + " + ".join(["b" * 30] * 4)]
