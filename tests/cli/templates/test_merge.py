"""Merging two changed versions of a text."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from ifgen.generator_py.templates.exports import merge

TEXTS = st.lists(st.sampled_from(["a\n", "b\n", "c\n", "d\n"]), max_size=8).map("".join)


@given(TEXTS, TEXTS)
def test_the_change_of_one_side_is_taken(base: str, changed: str) -> None:
    assert merge(base, changed, base) == merge(base, base, changed) == merge(base, changed, changed)
    assert (merge(base, changed, base).text, merge(base, changed, base).conflicts) == (changed, 0)


@given(TEXTS, TEXTS, TEXTS)
def test_nothing_of_either_side_gets_lost(base: str, first: str, second: str) -> None:
    merged = merge(base, first, second)
    assert merged.conflicts == merged.text.count("<<<<<<<") == merged.text.count(">>>>>>>")
    assert merge(base, second, first).conflicts == merged.conflicts
    for line in {*first.splitlines(), *second.splitlines()} - {*base.splitlines()}:
        assert line in merged.text.splitlines()


def test_a_last_line_without_an_end() -> None:
    assert merge("a\nb", "a\nc", "a\nd").text == (
        "a\n<<<<<<< ifgen's template now\nc\n||||||| as it was exported\nb\n=======\nd\n>>>>>>> your template\n"
    )
    assert merge("a\nb", "x\nb", "a\nb").text == "x\nb"
