"""`ifgen fmt`: what it changes, what it leaves, and how the command behaves."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.diagnostics import InputError, Source
from ifgen.formatting import formatted, has_style

from .conftest import Run, write

ROOT = Path(__file__).parents[2]
SHARE = Path(sys.prefix) / "share"
IDL = [*SHARE.glob("*/*/*.idl"), *ROOT.glob("tests/**/*.idl"), *ROOT.glob("examples/**/*.idl")]
NODL = [path for path in ROOT.glob("*/**/*.nodl.*") if has_style(path)]

STYLES = {
    "spaces": ("float64   x\t1.5\nint8[3]  y  [ 1 ,2,3 ]", "float64 x 1.5\nint8[3] y [1, 2, 3]\n"),
    "constants": (
        "int8 A=1\nint8 B  =  -2\nstring CC=  a  b  ",
        "int8 A = 1\nint8 B = -2\nstring CC = a  b\n",
    ),
    "comments": (
        "#a\n#b\n\nfloat64 x #[m]\nfloat64 y    # two\n",
        "# a\n# b\n\nfloat64 x  # [m]\nfloat64 y  # two\n",
    ),
    "a comment with and without a space": ("#a\n# b\nint8 x\n", "#a\n# b\nint8 x\n"),
    "an empty line at the start": ("\n\n#of x\nint8 x\n\n\n", "\n# of x\nint8 x\n"),
    "aligned names": ("float64   x\nint8      y\nbool z\n", "float64 x\nint8    y\nbool z\n"),
    "aligned values": (
        "int8 A   = 1\nint8 LONG= 2\nint8 B = 3\n",
        "int8 A    = 1\nint8 LONG = 2\nint8 B = 3\n",
    ),
    "aligned comments": (
        "float64 x       # one\n                # more\nfloat64 y_long  # two\nbool z # three\n",
        "float64 x       # one\n                # more\nfloat64 y_long  # two\nbool z  # three\n",
    ),
    "comments below move along": (
        "float64 x     # one\n              # more\n  # else\n",
        "float64 x  # one\n           # more\n  # else\n",
    ),
    "boxes": ("####\n#  a #\n####\nint8 x\n", "####\n#  a #\n####\nint8 x\n"),
    "quotes": ("string[] s  [ 'a' ,\"b\"]\n", "string[] s [ 'a' ,\"b\"]\n"),
    "directives": ("int8 x #ifgen: ignore[a]\n", "int8 x  #ifgen: ignore[a]\n"),
    "optional": (
        "@optional   int8  x #a\n@optional # why\nint8 y",
        "@optional int8 x  # a\n@optional  # why\nint8 y\n",
    ),
    "nothing": ("\n \n", ""),
}


@pytest.mark.parametrize("name", STYLES)
def test_the_style_of_interfaces(name: str) -> None:
    before, after = STYLES[name]
    assert formatted(Source(Path("A.msg"), before)) == after
    assert formatted(Source(Path("A.msg"), after)) == after


def test_the_example_of_the_page() -> None:
    page = (ROOT / "docs/cli.md").read_text().partition("## fmt")[2]
    before = page.partition("```text\n")[2].partition("```")[0]
    after = page.partition("$ cat demo_msgs/msg/Step.msg\n")[2].partition("```")[0]
    assert formatted(Source(Path("Step.msg"), before)) == after != before


def test_new_files_are_in_the_style(ifgen: Run) -> None:
    for name in ("demo_msgs/msg/Step", "demo_msgs/srv/Move", "demo_msgs/action/Walk"):
        assert ifgen("new", "interface", name).code == 0
    assert ifgen("new", "node", "demo_nodes/walker").code == 0
    assert ifgen("fmt", "--check", ".").out == "0 files not in the style, of 4\n"


def test_separators() -> None:
    text = "int8  a\n\n\n---\n\n\n#of b\nint8  b #c\n---\n"
    assert formatted(Source(Path("A.action"), text)) == "int8 a\n\n---\n\n# of b\nint8 b  # c\n---\n"


def test_the_style_of_idl() -> None:
    before = (
        '#include "a/msg/B.idl"\nmodule demo {\nmodule msg {\n    struct Pose {\n'
        '    @verbatim (language="comment", text=\n"x" "\\n"\n      "y")\n\n\n      double x; // m  \n'
        "  /* as it\n     is */\n  };\n};\n};"
    )
    after = (
        '#include "a/msg/B.idl"\nmodule demo {\n  module msg {\n    struct Pose {\n'
        '      @verbatim (language="comment", text=\n        "x" "\\n"\n        "y")\n\n      double x; // m\n'
        "      /* as it\n     is */\n    };\n  };\n};\n"
    )
    assert formatted(Source(Path("A.idl"), before)) == after


def test_the_style_of_nodl() -> None:
    before = (
        "#!/usr/bin/env x\nnodl_version:   2 #a\n\n\npublishers:\n  - name: chatter   #b\n    type:    std_msgs/msg/String\n"
        "    description: |  \n      two   # no comment\n\n\n      lines\n"
    )
    after = (
        "#!/usr/bin/env x\nnodl_version: 2  # a\n\npublishers:\n  - name: chatter  # b\n    type: std_msgs/msg/String\n"
        "    description: |\n      two   # no comment\n\n\n      lines\n"
    )
    assert formatted(Source(Path("a.nodl.yaml"), before)) == after
    json = '{"nodl_version": 2,\n"publishers": [\n{"name": "a{"\n}]\n}'
    assert formatted(Source(Path("a.nodl.json"), json)) == (
        '{"nodl_version": 2,\n  "publishers": [\n    {"name": "a{"\n  }]\n}\n'
    )


@pytest.mark.parametrize("path", [*IDL, *NODL], ids=lambda path: "/".join(path.parts[-3:]))
def test_twice_is_as_once(path: Path) -> None:
    agrees(path.name, path.read_text())


@settings(max_examples=200)
@given(st.data())
def test_changed_files(data: st.DataObject) -> None:
    """Real files with some characters changed are formatted or refused, and never mean something else."""
    path = data.draw(st.sampled_from(NODL if data.draw(st.booleans()) else IDL))
    text = path.read_text()
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        piece = data.draw(
            st.sampled_from(
                ["\n", "  ", "\t", "#", "'", '"', "{", "}", "[", ",", "//", "/*", ": ", "|", "\\"]
            )
        )
        text = text[:start] + piece + text[start + data.draw(st.integers(0, 2)) :]
    agrees(path.name, text)


def agrees(name: str, text: str) -> None:
    try:
        after = formatted(Source(Path(name), text))
    except InputError as error:
        assert "unsafe-format" not in {problem.rule for problem in error.diagnostics}, error
        return
    assert formatted(Source(Path(name), after)) == after


def test_it_writes_checks_and_shows(ifgen: Run, tmp_path: Path) -> None:
    file = write(tmp_path / "demo_msgs/msg/Pose.msg", "float64   x\n")
    write(tmp_path / "demo_msgs/msg/Good.msg", "float64 x\n")
    checked = ifgen("fmt", "--check", "demo_msgs")
    assert (checked.code, checked.out) == (
        1,
        "not in the style: demo_msgs/msg/Pose.msg\n1 file not in the style, of 2\n",
    )
    shown = ifgen("fmt", "--diff", "demo_msgs")
    assert shown.code == 1 and "-float64   x\n+float64 x\n" in shown.out
    assert file.read_text() == "float64   x\n"
    done = ifgen("fmt", "demo_msgs")
    assert (done.code, done.out) == (0, "formatted: demo_msgs/msg/Pose.msg\n1 file formatted, of 2\n")
    assert file.read_text() == "float64 x\n"
    assert ifgen("fmt", "--check", "-q", "demo_msgs").code == 0


def test_files_with_mistakes_stay(ifgen: Run, tmp_path: Path) -> None:
    bad = write(tmp_path / "demo_msgs/msg/Bad.msg", "float64\n")
    bytes_ = tmp_path / "demo_msgs/msg/Bytes.msg"
    bytes_.write_bytes(b"float64   x # \xff\n")
    good = write(tmp_path / "demo_msgs/msg/Good.msg", "float64   x\n")
    done = ifgen("fmt", "demo_msgs")
    assert done.code == 1
    assert "demo_msgs/msg/Bad.msg:1:" in done.err and "Bytes.msg" in done.err
    assert bad.read_text() == "float64\n" and bytes_.read_bytes() == b"float64   x # \xff\n"
    assert good.read_text() == "float64 x\n"


def test_line_ends_stay(ifgen: Run, tmp_path: Path) -> None:
    file = tmp_path / "A.msg"
    file.write_bytes(b"float64   x\r\nint8 y\r\n\r\n")
    assert ifgen("fmt", file).code == 0
    assert file.read_bytes() == b"float64 x\r\nint8 y\r\n"


def test_standard_input(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"float64   x\n")))
    refused = ifgen("fmt", "-")
    assert refused.code == 2 and "--stdin-filename Pose.msg" in refused.err
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"float64   x\n")))
    done = ifgen("fmt", "-", "--stdin-filename", "Pose.msg")
    assert (done.code, done.out) == (0, "float64 x\n")


def test_other_files_are_refused(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "a.txt", "x")
    refused = ifgen("fmt", "a.txt")
    assert refused.code == 2
    assert "a.txt has no style" in refused.err
