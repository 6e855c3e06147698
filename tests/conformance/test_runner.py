"""`ifgen conformance` with testees that do what they should not."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result
from ifgen_tools.conformance.commands import conformance

TYPE = "geometry_msgs/msg/Point"
PAYLOAD = "0001000000000000000000000000000000000000000000000000f03f"
CASES = {
    "wire/a": f"wire {TYPE} {PAYLOAD}",
    "hash/b": f"hash {TYPE} RIHS01_b",
    "text/c": f"recode {TYPE} 00 refused|{PAYLOAD}",
}
# Answers from a table, which maps an operation to a reply without its number.
PROGRAM = """
import os, sys, time
TABLE = {table!r}
for line in sys.stdin:
    op, number, *rest = line.split()
    verdict, _, data = TABLE.get(op, "skip op").partition(" ")
    if verdict == "crash":
        os._exit(3)
    if verdict == "sleep":
        time.sleep(30)
    print(verdict, number, data, flush=True)
"""
RIGHT = {
    "hello": "ok protocol=1 language=python",
    "hash": "ok RIHS01_b",
    "recode": f"ok {PAYLOAD}",
    "dump": "ok x=0000000000000000 y=0000000000000000 z=3ff0000000000000",
    "load": f"ok {PAYLOAD}",
    "size": "ok 28",
}


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("suite")
    (folder / "cases").mkdir()
    (folder / "interfaces").mkdir()
    (folder / "cases/all.txt").write_text("".join(f"{name} {case}\n" for name, case in CASES.items()))
    return folder


def run(suite: Path, table: dict[str, str], *options: str) -> Result:
    """Run the command with a testee that answers from a table."""
    program = suite / "testee.py"
    program.write_text(PROGRAM.format(table=RIGHT | table))
    command = ["--cases", str(suite), *options, "--", sys.executable, str(program)]
    return CliRunner().invoke(conformance, command, standalone_mode=False)


def test_a_right_testee_passes(suite: Path) -> None:
    result = run(suite, {})
    assert (result.return_value, result.stdout.splitlines()[-1].split()) == (0, ["all", "6", "0", "0", "0"])


def test_each_wrong_answer_is_shown_with_its_case(suite: Path) -> None:
    result = run(suite, {"size": "ok 27", "hash": "fail no idea", "load": "refused this"})
    assert result.return_value == 1
    assert "wire/a:size: expected 28, got ok 27" in result.stdout
    assert "hash/b:hash: expected RIHS01_b, got fail no idea" in result.stdout
    assert "wire/a:load: " in result.stdout


def test_a_testee_may_refuse_only_where_that_is_right(suite: Path) -> None:
    result = run(suite, {"recode": "refused bad"})
    assert "wire/a:recode: expected" in result.stdout
    assert "text/c" not in result.stdout


def test_a_crash_is_the_case_s_and_the_program_starts_again(suite: Path) -> None:
    result = run(suite, {"dump": "crash"})
    assert "wire/a:dump: expected" in result.stdout
    assert "got crash exit code 3" in result.stdout
    assert result.stdout.splitlines()[-1].split() == ["all", "5", "1", "0", "0"]


def test_a_testee_that_hangs_fails_in_time(suite: Path) -> None:
    result = run(suite, {"size": "sleep"}, "--timeout", "0.3", "--only", "*:size")
    assert "wire/a:size: expected 28, got timeout no reply within 0.3 s" in result.stdout


def test_what_a_testee_does_not_have_is_skipped(suite: Path) -> None:
    result = run(suite, {"size": "skip size", "hello": "ok protocol=1 language=c skip=hash,dump"})
    assert (result.return_value, result.stdout.splitlines()[-1].split()) == (0, ["all", "3", "0", "0", "3"])


def test_expected_failures_do_not_count(suite: Path) -> None:
    (suite / "list.txt").write_text("# what it cannot\nwire/*:size  it counts from 1\n")
    result = run(suite, {"size": "ok 29"}, "--failures", str(suite / "list.txt"))
    assert (result.return_value, result.stdout.splitlines()[-1].split()) == (0, ["all", "5", "0", "1", "0"])


def test_an_expected_failure_that_passes_is_an_error(suite: Path) -> None:
    (suite / "list.txt").write_text("wire/*  wrong\n")
    result = run(suite, {"size": "ok 29"}, "--failures", str(suite / "list.txt"))
    assert result.return_value == 1
    assert "line 1: `wire/*` should fail, but wire/a:recode and 2 more passed" in result.stderr


def test_some_of_the_cases_of_a_pattern_may_pass(suite: Path) -> None:
    (suite / "list.txt").write_text("some wire/*  wrong\n")
    assert run(suite, {"size": "ok 29"}, "--failures", str(suite / "list.txt")).return_value == 0
    assert run(suite, {}, "--failures", str(suite / "list.txt")).return_value == 1


def test_a_line_without_a_reason_is_refused(suite: Path) -> None:
    (suite / "list.txt").write_text("wire/*\n")
    result = run(suite, {}, "--failures", str(suite / "list.txt"))
    assert "list.txt:1: expected `[some] PATTERN REASON`" in str(result.exception)


def test_results_for_tools(suite: Path, tmp_path: Path) -> None:
    files = tmp_path / "result.xml", tmp_path / "result.json"
    run(suite, {"size": "ok 29", "load": "skip load"}, "--junit", str(files[0]), "--json", str(files[1]))
    root = ElementTree.parse(files[0]).getroot()
    assert (root.attrib["tests"], root.attrib["failures"], root.attrib["skipped"]) == ("6", "1", "1")
    data = json.loads(files[1].read_text())
    assert data["groups"]["wire"] == {"passed": 2, "skipped": 1, "failed": 1}
    assert [case["name"] for case in data["cases"]] == ["wire/a:load", "wire/a:size"]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"hello": "ok language=c"}, "does not answer `hello`: ok language=c"),
        ({"hello": "crash"}, "does not answer `hello`: crash exit code 3"),
    ],
)
def test_a_program_that_is_no_testee(suite: Path, table: dict[str, str], words: str) -> None:
    assert words in str(run(suite, table).exception)


def test_a_program_that_is_not_there(suite: Path) -> None:
    result = CliRunner().invoke(conformance, ["--cases", str(suite), "./none"], standalone_mode=False)
    assert "cannot start ./none: No such file or directory" in str(result.exception)


def test_a_pattern_that_no_case_has(suite: Path) -> None:
    assert "no case has a name like 'x/*'" in str(run(suite, {}, "--only", "x/*").exception)


EMPTY = "random/std_msgs/msg/Empty"


def test_random_messages(suite: Path) -> None:
    answers = {"load": "ok 0001000000", "dump": "ok ", "equal": "ok 1"}
    result = run(suite, answers, "--random", "3", "--only", EMPTY)
    counts = "3 messages of 1 types"
    assert (result.return_value, result.stdout) == (0, f"{counts}: 0 differ in bytes, 0 in values\n")
    result = run(suite, answers | {"equal": "crash", "load": "ok 00"}, "--random", "3", "--only", EMPTY)
    assert result.return_value == 1
    assert "load std_msgs/msg/Empty : expected 0001000000, got ok 00" in result.stdout
    assert (
        "equal std_msgs/msg/Empty 0001000000 0001000000: expected 1, got crash exit code 3" in result.stdout
    )
    assert result.stdout.endswith(f"{counts}: 3 differ in bytes, 3 in values\n")


def test_random_messages_of_a_type_that_is_unknown(suite: Path) -> None:
    unknown = dict.fromkeys(("load", "dump", "equal"), "skip unknown-type")
    result = run(suite, unknown, "--random", "3", "--only", EMPTY)
    assert result.return_value == 1
    assert result.stdout.endswith("in values, 1 types skipped\n")
