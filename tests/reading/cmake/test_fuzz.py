"""Reading any CMakeLists.txt ends soon, with an answer."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.reading import interface_list
from ifgen.reading.cmake.commands import SETTERS
from ifgen.reading.cmake.text import SyntaxProblem, commands
from ifgen.reading.storage import read_source

from .test_forms import forms

PIECES = sorted(
    {
        *(word for form in forms() for text in form.files.values() for word in text.split()),
        *(
            "(",
            ")",
            '"',
            "\\",
            "${",
            "}",
            "[[",
            "]]",
            "[=[",
            "]=]",
            "#",
            "#[[",
            ";",
            "\n",
            "$<",
            "$ENV{",
            ":",
        ),
        *(
            "endif()",
            "endforeach()",
            "if(",
            "foreach(x RANGE 999999999)",
            "while(1)",
            "endwhile()",
            "macro(m)",
        ),
        *("m(${x})", "endmacro()", "include(CMakeLists.txt)", 'set(x "${x}${x}${x}x;")', "list(GET x -1 x)"),
        *('list(FILTER x INCLUDE REGEX "(.*)*")', 'string(REGEX REPLACE ".*.*.*" "" x "${x}")'),
        *("return()", "file(GLOB_RECURSE x /*)", "string(SUBSTRING x 0 99999999999 x)", "unset(x)"),
    }
)


def read(root: Path, text: str) -> interface_list.InterfaceList | None:
    (root / "msg").mkdir(exist_ok=True)
    (root / "msg/A.msg").touch()
    (root / "CMakeLists.txt").write_text(text, encoding="utf-8")
    return interface_list.of_source(root, read_source(root / "CMakeLists.txt"), [root / "msg/A.msg"], [])


@settings(max_examples=150)
@given(st.lists(st.sampled_from(PIECES) | st.text(max_size=5), max_size=60).map(" ".join))
def test_any_text_has_an_answer(tmp_path: Path, text: str) -> None:
    listed = read(tmp_path, text + "\nrosidl_generate_interfaces(x msg/A.msg)")
    assert listed is not None
    assert listed.paths == (tmp_path / "msg/A.msg",) or listed.diagnostics


@settings(max_examples=100)
@given(st.data())
def test_any_mutation_of_a_form_has_an_answer(tmp_path: Path, data: st.DataObject) -> None:
    form = data.draw(st.sampled_from(list(forms())))
    text = form.files["CMakeLists.txt"]
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(st.sampled_from(PIECES)) + text[at + data.draw(st.integers(0, 20)) :]
    read(tmp_path, text)


@pytest.mark.parametrize(
    "name", sorted({*SETTERS, "if", "foreach", "while", "function", "include", "rosidl_generate_interfaces"})
)
def test_commands_without_arguments(tmp_path: Path, name: str) -> None:
    end = f"end{name}()\n" if name in {"if", "foreach", "while", "function"} else ""
    for arguments in (
        "",
        "${nothing}",
        '""',
        '"" "" ""',
        "GLOB",
        "APPEND",
        "REGEX REPLACE",
        "x IN",
        "x RANGE",
    ):
        read(tmp_path, f"{name}({arguments})\n{end}rosidl_generate_interfaces(x msg/A.msg)")


HOSTILE = {
    "a value that doubles": 'set(x x)\nforeach(i RANGE 100)\nset(x "${x}${x}")\nendforeach()\n',
    "a list that doubles": "set(x a b)\nforeach(i RANGE 100)\nlist(APPEND x ${x})\nendforeach()\n",
    "a loop without end": "while(TRUE)\nset(x 1)\nendwhile()\n",
    "loops in loops": "foreach(i RANGE 9999)\n" * 9 + "set(x 1)\n" + "endforeach()\n" * 9,
    "a function that calls itself": "function(f)\nf(${ARGN} a)\nf(b ${ARGN})\nendfunction()\nf(x)\n",
    "a macro that calls itself": "macro(f)\nf(${ARGN} ${ARGN})\nendmacro()\nf(x)\n",
    "a file that includes itself": "include(CMakeLists.txt)\nadd_subdirectory(.)\n" * 5,
    "deep blocks": "if(a)\n" * 3000 + "endif()\n" * 3000,
    "deep parentheses": "if(" + "(" * 30000 + ")" * 30000 + ")\nendif()\n",
    "deep references": "set(x " + "${" * 30000 + "}" * 30000 + ")\n",
    "many negations": "if(" + "NOT " * 30000 + "x)\nendif()\n",
    "a pattern that explodes": f'if("{"a" * 90}!" MATCHES "(a*)*$")\nendif()\nif("{"a" * 90}" MATCHES "a*a*a*b")\nendif()\n'
    * 30,
    "optional letters": f'string(REGEX MATCH "{"a?" * 60}{"a" * 60}" x "{"a" * 60}")\n',
    "the whole disk": "file(GLOB_RECURSE x /*.msg)\nfile(GLOB y /*/*/*/*/*/*)\n",
    "a range beyond measure": "foreach(i RANGE 999999999)\nendforeach()\n",
    "a long list": "set(x " + "a;" * 300000 + ")\nforeach(i ${x})\nlist(LENGTH x n)\nendforeach()\n",
    "brackets without end": "set(x [[" + "[=[" * 100000,
    "quotes without end": '"' * 100001,
    "backslashes": "set(x " + "\\" * 200001,
}


LONG = {"a long list", "a macro that calls itself"}


@pytest.mark.parametrize(
    "what", [pytest.param(what, marks=[pytest.mark.slow] if what in LONG else []) for what in HOSTILE]
)
def test_hostile_files_end_soon(tmp_path: Path, what: str) -> None:
    """The limit is on CPU time, so that a busy machine does not fail; the worst file takes a tenth of it."""
    started = time.process_time()
    assert read(tmp_path, HOSTILE[what] + "rosidl_generate_interfaces(x msg/A.msg)") is not None
    assert time.process_time() - started < 10


@pytest.mark.parametrize(
    "piece",
    [
        *("a\n", '"', "[[", "("),
        *(
            pytest.param(piece, marks=pytest.mark.slow)
            for piece in ("x()", "a(b c)\n", "#[[", "\\", '\\"', "set(a ", "a(\\\n")
        ),
    ],
)
def test_text_is_taken_apart_in_linear_time(piece: str) -> None:
    def cost(count: int) -> float:
        started = time.process_time()
        with contextlib.suppress(SyntaxProblem):
            commands("a(" + piece * count)
        return time.process_time() - started

    assert cost(80_000) < 80 * max(cost(8_000), 0.001)
