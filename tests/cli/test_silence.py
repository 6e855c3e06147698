"""The configuration and comments silence warnings, or turn them into errors."""

from __future__ import annotations

import json
from pathlib import Path

import ifgen as toolkit
import pytest

from .conftest import Outcome, Run, write

QOS = "qos: {history: KEEP_ALL, reliability: RELIABLE}"


def rules(done: Outcome) -> list[str]:
    """The rules that `check --format json` names, one for each diagnostic."""
    return [diagnostic["rule"] for diagnostic in json.loads(done.out)["diagnostics"]]


def check(ifgen: Run, text: str, name: str = "demo_msgs/msg/Pose.msg") -> list[str]:
    write(Path(name), text)
    return rules(ifgen("check", Path(name).parts[0], "--format", "json"))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("string class  # ifgen: ignore[keyword-name]", []),
        ("string class  # its kind [m] # ifgen:ignore[unlikely-unit,  keyword-name] for the old one", ["unused-ignore"]),
        ("# ifgen: ignore[keyword-name]\nstring class", []),
        ("# ifgen: ignore[keyword-name]\n\n# The class.\nstring class\nstring def", ["keyword-name"]),
        ("uint8 a\n# ifgen: ignore[keyword-name]\n  # of a\nstring class", []),
        ("# ifgen: ignore[backslash-in-comment]\n# At C:\\new.\nstring a", []),
        ("string a  # at C:\\new  # ifgen: ignore[backslash-in-comment]", []),
        ("string class\n# ifgen: ignore[keyword-name]\nstring a", ["keyword-name", "unused-ignore"]),
        ("string class # ifgen: ignore", ["keyword-name", "unused-ignore"]),
        ("string class # ifgen: ignore[]", ["keyword-name", "unused-ignore"]),
        ("string class # ifgen: ignored anyway", ["keyword-name"]),
        ("float x # ifgen: ignore[invalid-type]", ["invalid-type"]),
        ("string class # ifgen: ignore[reserved-name]\nfloat x", ["invalid-type", "keyword-name"]),
    ],
)  # fmt: skip
def test_a_comment_silences_a_warning(ifgen: Run, text: str, found: list[str]) -> None:
    assert check(ifgen, text + "\n") == found


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("double class;  // its kind  // ifgen: ignore[keyword-name]", []),
        ("double class;  /* ifgen: ignore[keyword-name] */", []),
        ("// ifgen: ignore[keyword-name]\ndouble class;\ndouble def;", ["keyword-name"]),
        ("/* ifgen: ignore[keyword-name] */\ndouble class;\ndouble def;", ["keyword-name"]),
        ("double a;  // ifgen: ignore[keyword-name]", ["unused-ignore"]),
        ("double a  // ifgen: ignore[keyword-name]", ["idl-syntax"]),
    ],
)
def test_a_comment_silences_a_warning_in_an_idl_file(ifgen: Run, line: str, found: list[str]) -> None:
    text = f"""
// ifgen: ignore[missing-include]
#include "none_msgs/msg/One.idl"
#include "none_msgs/msg/Two.idl"  // ifgen: ignore[missing-include]
module demo_msgs {{ module msg {{ struct Pose {{
{line}
}}; }}; }};
"""
    assert check(ifgen, text, "demo_msgs/msg/Pose.idl") == found


def test_an_unused_comment_is_told_with_what_was_meant(ifgen: Run) -> None:
    write(
        Path("demo_msgs/msg/Pose.msg"),
        "string a  # ifgen: ignore[keyword-nam, invalid-type, keyword-name]\n",
    )
    done = ifgen("check", "demo_msgs")
    assert done.code == 0
    assert done.out.startswith(
        "warning[unused-ignore]: there is no rule `keyword-nam`\n"
        " --> demo_msgs/msg/Pose.msg:1:27\n"
        "  |\n"
        "1 | string a  # ifgen: ignore[keyword-nam, invalid-type, keyword-name]\n"
        "  |                           ^^^^^^^^^^^ this silences nothing\n"
        "  = help: did you mean `keyword-name`?\n"
    )
    assert "`invalid-type` is an error, which cannot be ignored\n" in done.out
    assert "there is no warning `keyword-name` here\n" in done.out


def test_a_comment_changes_nothing_else(ifgen: Run) -> None:
    plain = "# A pose.\n# Of mine.\n\nstring class  # its kind\n# How far [m]\nfloat64 x\nfloat64 y  # [m]\n"
    silent = (
        "# A pose.\n# ifgen: ignore[keyword-name]\n# Of mine.\n\n"
        "string class  # its kind # ifgen: ignore[keyword-name] by the vendor\n"
        "# ifgen: ignore[unlikely-unit]\n# How far [m]\nfloat64 x\n"
        "float64 y  # [m] # ifgen: ignore[unlikely-unit]\n"
    )
    made: list[str] = []
    for text in (plain, silent):
        write(Path("demo_msgs/msg/Pose.msg"), text)
        shown = ifgen("show", "demo_msgs/msg/Pose", "-I", "demo_msgs").out
        ifgen("generate", "demo_msgs")
        code, source = Path("generated/demo_msgs/msg/_pose.py").read_text().split('__source__ = """\\\n')
        assert source.startswith(text), "what ROS calls the raw source"
        made.append(shown + code)
    assert made[0] == made[1]
    assert "ifgen: ignore" not in made[1]


def test_comments_in_descriptions_of_nodes_and_modules_of_theirs(ifgen: Run) -> None:
    topics = f"publishers:\n  - {{name: /a/b, type: std_msgs/String, {QOS}}}\n  - {{name: a_b, type: std_msgs/String, {QOS}}}"
    assert check(ifgen, f"nodl_version: 2\n{topics}\n", "demo/nodl/talker.nodl.yaml") == ["same-method"]
    topics += "  # ifgen: ignore[same-method]"
    assert check(ifgen, f"nodl_version: 2\n{topics}\n", "demo/nodl/talker.nodl.yaml") == []
    module = "class Talker(TalkerBase):\n    def on_x(self): ...{}\n    def on_y(self): return 1{}\n"
    ignore = "  # ifgen: ignore[orphaned-method]"
    path = write(Path("generated/demo/demo/talker.py"), module.format("", ignore))
    assert rules(ifgen("check", "demo", "--format", "json")) == ["orphaned-method"]
    path.write_text(module.format(ignore, ignore) + "\n" + ignore.strip())
    assert rules(ifgen("check", "demo", "--format", "json")) == ["unused-ignore"]


def test_comments_in_what_describes_a_package(ifgen: Run) -> None:
    cmake = "project(demo_msgs)\n{}rosidl_generate_interfaces(${{PROJECT_NAME}} ${{CMAKE_CURRENT_SOURCE_DIR}}/msg/Pose.msg)\n"
    write(Path("demo_msgs/msg/Pose.msg"), "int8 a\n")
    assert check(ifgen, cmake.format(""), "demo_msgs/CMakeLists.txt") == ["unusual-path"]
    silent = cmake.format("# ifgen: ignore[unusual-path]\n")
    assert check(ifgen, silent, "demo_msgs/CMakeLists.txt") == []
    assert check(ifgen, silent.replace("${CMAKE_CURRENT_SOURCE_DIR}/", ""), "demo_msgs/CMakeLists.txt") == [
        "unused-ignore"
    ]
    xml = "<package>\n<name>{}</name> <!-- ifgen: ignore[hiding-name] -->\n</package>\n"
    write(Path("my_msgs/msg/Pose.msg"), "int8 a\n")
    assert check(ifgen, xml.format("my_msgs"), "my_msgs/package.xml") == ["unused-ignore"]
    assert check(ifgen, xml.format("graphlib"), "my_msgs/package.xml") == []


def test_a_comment_about_a_node_that_was_not_checked_does_not_count_as_unused(ifgen: Run) -> None:
    said = "nodl_version: 2\n{}:\n  - {{name: /a, type: std_msgs/String, qos: {{history: KEEP_ALL, reliability: {}}}}}{}\n"
    write(Path("demo/nodl/talker.nodl.yaml"), said.format("publishers", "BEST_EFFORT", ""))
    listener = said.format("subscriptions", "RELIABLE", "  # ifgen: ignore[never-meet]")
    assert check(ifgen, listener, "demo/nodl/listener.nodl.yaml") == []
    assert rules(ifgen("check", "demo/nodl/listener.nodl.yaml", "--format", "json")) == []


WARNED = "string class\nstring def\nfloat32 far 1e39\n"


@pytest.mark.parametrize(
    ("keys", "found"),
    [
        ('ignore = ["keyword-name"]', ["float32-range"]),
        ('ignore = ["keyword-name", "float32-range"]', []),
        ('per_file_ignores = {"demo_msgs/*" = ["keyword-name"]}', ["float32-range"]),
        ('per_file_ignores = {"Pose.msg" = ["keyword-name"], "*/msg/P*" = ["float32-range"]}', []),
        (
            'per_file_ignores = {"msg/*" = ["keyword-name"]}',
            ["keyword-name", "keyword-name", "float32-range"],
        ),
    ],
)
def test_the_configuration_silences_warnings(ifgen: Run, keys: str, found: list[str]) -> None:
    write(Path("demo_msgs/msg/Pose.msg"), WARNED)
    write(Path("pyproject.toml"), f'[tool.ifgen]\npaths = ["demo_msgs"]\n{keys}\n')
    assert rules(ifgen("check", "--format", "json")) == found
    assert rules(ifgen("check", "../" + Path.cwd().name + "/demo_msgs", "--format", "json")) == found
    for more in ((), (), ("--check",)):  # the second run has nothing to do
        assert ifgen("generate", *more).err.count("warning[") == len(found)


def test_silence_makes_room_for_the_warnings_after(ifgen: Run) -> None:
    fields = [f"string a{i}\nfloat32 b{i} 1e39\n" for i in range(30)]
    write(Path("demo_msgs/msg/Pose.msg"), "".join(fields) + "string class\n")
    done = ifgen("check", "demo_msgs")
    assert done.out.count("warning[float32-range]") == 20
    assert "warning[more-warnings]: and 11 more warnings in this file\n" in done.out
    assert len(toolkit.check("demo_msgs")) == 31
    write(Path("pyproject.toml"), '[tool.ifgen]\nignore = ["float32-range"]\n')
    assert rules(ifgen("check", "demo_msgs", "--format", "json")) == ["keyword-name"]


def test_an_unknown_rule_in_the_configuration(ifgen: Run) -> None:
    write(
        Path("pyproject.toml"),
        '[tool.ifgen]\nignore = ["float32-range", "keywrd-name"]\nper_file_ignores.x = ["unknown-type"]\n',
    )
    done = ifgen("check", ".")
    assert (done.code, done.out) == (2, "")
    assert done.err == (
        "error[configuration]: there is no rule `keywrd-name`\n"
        " --> pyproject.toml:2:28\n"
        "  |\n"
        '2 | ignore = ["float32-range", "keywrd-name"]\n'
        "  |                            ^^^^^^^^^^^^^ in 'ignore'\n"
        "  = help: did you mean `keyword-name` or `unknown-name`?\n"
        "\n"
        "error[configuration]: `unknown-type` is an error, which cannot be ignored\n"
        " --> pyproject.toml:3:23\n"
        "  |\n"
        '3 | per_file_ignores.x = ["unknown-type"]\n'
        "  |                       ^^^^^^^^^^^^^^ in 'per_file_ignores'\n"
        "\n"
        "2 errors\n"
    )


def test_strict_makes_errors_of_warnings(ifgen: Run) -> None:
    write(Path("demo_msgs/msg/Pose.msg"), "string class\n")
    for command in (("check",), ("generate",), ("generate",), ("generate", "--check")):
        done = ifgen(*command, "demo_msgs", "--strict")
        assert (done.code, (done.out + done.err).count("error[keyword-name]")) == (1, 1)
        assert ifgen(*command, "demo_msgs").code == 0
    assert Path("generated/demo_msgs/msg/_pose.py").exists(), "nothing is wrong with what is generated"
    write(Path("pyproject.toml"), "[tool.ifgen]\nstrict = true\n")
    assert ifgen("check", "demo_msgs").code == 1
    assert ifgen("check", "demo_msgs", "--no-strict").code == 0
    write(Path("pyproject.toml"), '[tool.ifgen]\nstrict = true\nignore = ["keyword-name"]\n')
    assert ifgen("check", "demo_msgs").code == 0


def test_warnings_of_others_are_not_told(ifgen: Run) -> None:
    """Packages found by -I or installed belong to somebody else, even if they are generated too."""
    write(Path("vendor/their_msgs/msg/A.msg"), "string class  # ifgen: ignore[float32-range]\n")
    write(Path("vendor/their_msgs/nodl/part.nodl.yaml"), _two_alike("/a/b", "a_b"))
    write(Path("demo_msgs/msg/B.msg"), "their_msgs/A a\n")
    write(Path("demo_msgs/nodl/b.nodl.yaml"), 'nodl_version: 2\ninclude: [{ref: "nodl://their_msgs/part"}]\n')
    assert rules(ifgen("check", "vendor", "--format", "json")) == [
        "keyword-name",
        "unused-ignore",
        "same-method",
    ]
    assert rules(ifgen("check", "demo_msgs", "-I", "vendor", "--format", "json")) == []
    assert ifgen("generate", "demo_msgs", "-I", "vendor", "--with-deps").err == ""
    write(Path("demo_msgs/msg/B.msg"), "their_msgs/Nothing a\n")
    assert rules(ifgen("check", "demo_msgs", "-I", "vendor", "--format", "json")) == ["unknown-type"]


def _two_alike(*names: str) -> str:
    topics = "".join(f"  - {{name: {name}, type: std_msgs/String, {QOS}}}\n" for name in names)
    return f"nodl_version: 2\npublishers:\n{topics}"


def test_quiet_prints_diagnostics_only(ifgen: Run, demo_msgs: Path) -> None:
    for command in (("check",), ("generate",), ("generate", "--check")):
        assert ifgen(*command, "demo_msgs", "-q") == Outcome(0, "", "")
    write(demo_msgs / "msg/Pose.msg", "string class\n")
    assert ifgen("generate", "demo_msgs", "--quiet").err.startswith("warning[keyword-name]")
    (demo_msgs / "msg/Pair.msg").unlink()
    (demo_msgs / "srv/Move.srv").unlink()
    assert ifgen("generate", "demo_msgs", "-q").out == ""
