"""The user's own functions whose annotations cannot be evaluated."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ifgen.config.customization import Customization
from ifgen.generator_py.templates.check import filters, types
from ifgen.generator_py.templates.render import look_for_problems


class LazilyAnnotated:
    """Like a function of CPython 3.14 whose annotations use names that only a type checker imports."""

    @property
    def __annotations__(self) -> Any:
        raise NameError("name 'Image' is not defined")

    __signature__ = __annotations__

    def __call__(self, value: Any) -> Any:
        return value


def test_annotations_that_cannot_be_read_say_nothing() -> None:
    function = LazilyAnnotated()
    assert filters.misfit(function, 3, ["no_such"], subject=True) is None
    assert filters.wanted_by(function) == types.ANYTHING
    assert filters.result_of_function(function) == types.ANYTHING


@pytest.mark.parametrize(
    ("annotation", "wanted"),
    [
        ("str", "text"),
        ("'str'", "text"),
        ("str | None", "nothing or text"),
        ("Optional[str]", "nothing or text"),
        ("int | float", "a number or an integer"),
        ("Any", None),
        ("Image", None),  # which only a type checker knows
        ("str | list[str]", None),
    ],
)
@pytest.mark.parametrize("future", ["from __future__ import annotations\n", ""])
def test_what_a_filter_is_for(tmp_path: Path, annotation: str, wanted: str | None, future: str) -> None:
    if annotation == "Image" and not future:
        annotation = "'Image'"
    (tmp_path / "filters.py").write_text(
        f"{future}from typing import Any, Optional\ndef js(value: {annotation}, image: 'Image' = None) -> str:\n"
        "    return str(value)\n"
    )
    (tmp_path / "templates/message_package").mkdir(parents=True)
    template = tmp_path / "templates/message_package/message.j2"
    custom = Customization(tmp_path / "templates", tmp_path / "filters.py")
    template.write_text("{{ message.fields|js }}\n")
    said = [problem.message for problem in look_for_problems(custom)]
    assert said == ([f"filter 'js' is for {wanted}, and this is a tuple of FieldText"] if wanted else [])
    template.write_text("{{ message.name|js }}\n")
    assert look_for_problems(custom) == []
