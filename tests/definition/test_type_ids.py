"""Toolkit and runtime import nothing of each other, and know types of fields by the same numbers."""

from __future__ import annotations

from enum import IntEnum

import pytest
from ifgen.definition import type_description as ours
from ifgen_runtime import type_description as theirs


@pytest.mark.parametrize(("one", "other"), [(ours.TypeId, theirs.TypeId), (ours.Kind, theirs.Kind)])
def test_the_numbers_are_the_same(one: type[IntEnum], other: type[IntEnum]) -> None:
    assert {each.name: each.value for each in one} == {each.name: each.value for each in other}
