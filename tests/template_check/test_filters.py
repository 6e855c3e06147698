"""Functions of the user's own whose annotations cannot be worked out."""

from __future__ import annotations

from typing import Any

from ifgen.generator_py.template_check import filters, types


class LazilyAnnotated:
    """As a function of CPython 3.14 that is annotated with names which only a type checker imports."""

    @property
    def __annotations__(self) -> Any:
        raise NameError("name 'Image' is not defined")

    __signature__ = __annotations__

    def __call__(self, value: Any) -> Any:
        return value


def test_annotations_that_cannot_be_read_say_nothing() -> None:
    function = LazilyAnnotated()
    assert filters.misfit(function, 3, ["no_such"], subject=True) is None
    assert not filters.wants_text(function)
    assert filters.result_of_function(function) == types.ANYTHING
