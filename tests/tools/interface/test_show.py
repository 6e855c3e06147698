"""`ifgen interface show`."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen.pipeline.lookup import find_types
from ifgen.reading.search_path import SearchPath
from ifgen_tools.interface.definitions import shown

from tests.cli.conftest import Run, write


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(
        tmp_path / "walk_msgs/msg/Step.msg",
        "# A step.\n# Two lines.\n\n  # indented\nwalk_msgs/Foot  foot   # which\n\nfloat64 x 0.1# [m]\n"
        'string name "a b"  # said\nuint8 LEFT=1   # of Step\n\n# the end\n',
    )
    write(tmp_path / "walk_msgs/msg/Foot.msg", "# A foot.\n\nint8[<=3] toes  # own\n")
    write(tmp_path / "walk_msgs/srv/Plan.srv", "# Asks.\nStep[] steps\n---\nbool ok # yes\n")
    return tmp_path


def test_own_comments(ifgen: Run, folder: Path) -> None:
    assert ifgen("interface", "show", "walk_msgs/msg/Step", "-I", folder).out == (
        "# A step.\n# Two lines.\n\n  # indented\nwalk_msgs/Foot  foot   # which\n\tint8[<=3] toes\n\n"
        'float64 x 0.1# [m]\nstring name "a b"  # said\nuint8 LEFT=1   # of Step\n\n# the end\n'
    )


def test_no_comments(ifgen: Run, folder: Path) -> None:
    assert ifgen("interface", "show", "walk_msgs/msg/Step", "-I", folder, "--no-comments").out == (
        'walk_msgs/Foot  foot\n\tint8[<=3] toes\nfloat64 x 0.1\nstring name "a b"\nuint8 LEFT=1\n'
    )


def test_all_comments(ifgen: Run, folder: Path) -> None:
    out = ifgen("interface", "show", "walk_msgs/srv/Plan", "-I", folder, "--all-comments").out
    assert out.startswith("# Asks.\nStep[] steps\n\t# A step.\n\t# Two lines.\n\n\t  # indented\n")
    assert "\twalk_msgs/Foot  foot   # which\n\t\t# A foot.\n\n\t\tint8[<=3] toes  # own\n" in out
    assert out.endswith("\t# the end\n---\nbool ok # yes\n")


def test_parts_and_idl(ifgen: Run, folder: Path) -> None:
    """What is in no .msg file is shown in its notation."""
    assert ifgen("interface", "show", "walk_msgs/srv/Plan_Response", "-I", folder).out == "bool ok # yes\n"
    write(
        folder / "idl_msgs/msg/Arm.idl",
        "module idl_msgs { module msg {\n  module Arm_Constants { const uint8 LEFT = 1; };\n"
        '  @verbatim (language="comment", text="An arm.")\n  struct Arm {\n'
        '    @unit (value="rad") @default (value=0.1) double angle;\n    sequence<string, 2> names;\n  };\n};};\n',
    )
    assert ifgen("interface", "show", "idl_msgs/msg/Arm", "-I", folder).out == (
        "# An arm.\nuint8 LEFT=1\nfloat64 angle 0.1 # [rad]\nstring[<=2] names\n"
    )


def test_the_type_comes_through_a_pipe(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("std_msgs/msg/Bool\n"))
    out = ifgen("interface", "show", "-").out
    assert out == ifgen("interface", "show", "std_msgs/Bool").out
    assert "bool data" in out
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    assert "nothing came through it" in ifgen("interface", "show", "-").err
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stdin", terminal)
    done = ifgen("interface", "show", "-")
    assert (done.code, "stdin is a terminal" in done.err) == (2, True)


def test_json_is_the_type_description(ifgen: Run) -> None:
    found = json.loads(ifgen("interface", "show", "std_msgs/msg/Bool", "--json").out)
    assert found["type_description"]["type_name"] == "std_msgs/msg/Bool"


def test_mistakes(ifgen: Run, folder: Path) -> None:
    done = ifgen("interface", "show", "std_msgs/msg/Strin")
    assert (done.code, "did you mean 'std_msgs/msg/String'" in done.err) == (1, True)
    done = ifgen("interface", "show", "Bool", "--no-comments", "--all-comments")
    assert (done.code, "exclude each other" in done.err) == (2, True)
    write(folder / "walk_msgs/msg/Bad.msg", "float65 x\n")
    done = ifgen("interface", "show", "walk_msgs/msg/Bad", "-I", folder)
    assert (done.code, "float65" in done.err) == (1, True)


def test_lines_are_those_that_rosidl_sees() -> None:
    """Comments begin, and messages are nested, where rosidl's own parser says so, for all our interfaces."""
    adapter = pytest.importorskip("rosidl_adapter.parser")

    def expected(name: str, comments: bool, nested_comments: bool, indent: str = "") -> Iterator[str]:
        package, _, short = name.split("/")
        source = registry.interface(name).source
        assert source is not None
        for line in source.text.splitlines():
            text, nested = line.rstrip(), None
            if line != "---":
                parsed = adapter.parse_message_string(package, short, line)
                definitions = [*parsed.fields, *parsed.constants]
                if not comments:
                    text = text.partition("#")[0].strip() if definitions else ""
                of_field = parsed.fields[0].type if parsed.fields else None
                if of_field is not None and not of_field.is_primitive_type():
                    nested = f"{of_field.pkg_name}/msg/{of_field.type}"
            if text or comments:
                yield indent + text if text else ""
            if nested:
                yield from expected(nested, nested_comments, nested_comments, indent + "\t")

    search = SearchPath()
    described, registry = find_types(
        ["geometry_msgs", "action_msgs", "sensor_msgs", "example_interfaces"], search
    )
    whole = [d for d in described if registry.get(d.type_name)]
    assert len(whole) > 80
    for each in whole:
        for choice, which in (("own", (True, False)), ("all", (True, True)), ("none", (False, False))):
            assert list(shown(each, registry, choice)) == list(expected(each.type_name, *which)), (
                each.type_name
            )  # type: ignore[arg-type]
