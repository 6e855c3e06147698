"""Interfaces where rosidl takes them, and calls that are not reached."""

from __future__ import annotations

from pathlib import Path

import ifgen
import pytest

PROJECT = "project(demo_msgs)\nfind_package(rosidl_default_generators REQUIRED)\n"
CALL = "rosidl_generate_interfaces(${PROJECT_NAME} %s)\n"


@pytest.mark.parametrize("kind", ["msg", "srv"])
@pytest.mark.parametrize("folder", ["idl", "deep/er"])
def test_an_idl_file_counts_by_its_module(kind: str, folder: str, tmp_path: Path) -> None:
    root = tmp_path / "demo_msgs"
    (root / folder).mkdir(parents=True)
    (root / "CMakeLists.txt").write_text(PROJECT + CALL % f"{folder}/Only.idl")
    structs = (
        "struct Only { int32 value; };"
        if kind == "msg"
        else "struct Only_Request { int32 a; };\nstruct Only_Response { int32 b; };"
    )
    (root / folder / "Only.idl").write_text(f"module demo_msgs {{\n  module {kind} {{\n{structs}\n}}; }};\n")
    assert ifgen.check(root) == ()
    ifgen.generate(root, output=tmp_path / "out")
    assert (tmp_path / f"out/demo_msgs/{kind}/_only.py").exists()


@pytest.mark.parametrize(
    ("before", "call", "said"),
    [
        (
            'option(WITH_MSGS "" OFF)\nif(NOT WITH_MSGS)\n  return()\nendif()\n',
            CALL % "msg/Pose.msg",
            "does not reach",
        ),
        ("# ", CALL % "msg/Pose.msg", "never calls"),
        ("", "", "never calls"),
    ],
)
def test_a_call_that_is_not_reached(before: str, call: str, said: str, tmp_path: Path) -> None:
    root = tmp_path / "demo_msgs"
    (root / "msg").mkdir(parents=True)
    (root / "msg/Pose.msg").write_text("float64 x\n")
    (root / "CMakeLists.txt").write_text(PROJECT + before + call)
    [found] = ifgen.check(root)
    assert (found.rule, said in found.message) == ("no-interface-list", True)


def test_words_of_two_tokens_are_not_glued(tmp_path: Path) -> None:
    root = tmp_path / "demo_msgs" / "msg"
    root.mkdir(parents=True)
    (root / "Pose.idl").write_text("module demo_msgs {modulemsg { struct Pose { float x; }; }; };\n")
    for found in ifgen.check(root.parent):
        assert "{" not in found.message, found
