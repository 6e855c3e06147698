"""The readers of names, rules and parameter files: any input leads to one clear error or a sound result."""

from __future__ import annotations

import math
import os
import threading
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from ifgen_runtime.parameters.parameter_scalars import read_scalar
from rclpy.impl.rcl import names
from rclpy.impl.rcl.arguments import (
    Arguments,
    ParameterOverrides,
    parse_arguments,
    parse_override_rule,
    rclpy_remove_ros_args,
    read_file,
)
from rclpy.impl.rcl.handle import RCLError, UnknownROSArgsError
from rclpy.impl.rcl.rules import RuleError, parse_remap_rule, remapped_topic

RULE_PIECES = st.sampled_from(
    ["a", "b_", "_c", "__", "__ns", "__node", "/", "~/", ":", ":=", ".", "*", "**", "rostopic://", "rosservice://", "\\1", "1", " ", "é"]
)  # fmt: skip
RULES = st.lists(RULE_PIECES, max_size=9).map("".join) | st.text(max_size=12)
YAML_PIECES = st.sampled_from(
    ["n", "/**", "ros__parameters", "a", "b", ":", ": ", "\n", "  ", "    ", "- ", "[", "]", "{", "}", ", ", "1", "1.5", "'x'", "&x ",
     "*x", "---\n", "|\n", "~", "#", '"']
)  # fmt: skip
YAML = st.lists(YAML_PIECES, max_size=25).map("".join) | st.text(max_size=40)
VALUES = st.recursive(
    st.sampled_from(["1", "x", "1.5", "yes", "''", "[]", "{}"]),
    lambda inner: (
        st.lists(inner, max_size=3).map(lambda each: f"[{', '.join(each)}]")
        | st.dictionaries(st.sampled_from("abc"), inner, max_size=3).map(
            lambda each: "{" + ", ".join(f"{key}: {value}" for key, value in each.items()) + "}"
        )
    ),
    max_leaves=8,
)


@given(RULES)
def test_remap_rules_are_read_or_refused(rule: str) -> None:
    """A rule that is read names topics that can be expanded."""
    warnings: list[str] = []
    try:
        read = parse_remap_rule(rule, warnings.append)
    except RuleError as error:
        assert str(error)
        return
    assert read.replacement
    remapped = remapped_topic([read], "/a/b", is_service=False, node_name="n", namespace="/")
    assert names.rclpy_get_validation_error_for_full_topic_name(remapped) is None


@given(RULES, st.text(max_size=10) | VALUES)
@example("a:=", "\x00")
@example("a:=", "!!")
def test_override_rules_are_read_or_refused(rule: str, value: str) -> None:
    """A rule that is read sets one parameter."""
    overrides = ParameterOverrides()
    try:
        parse_override_rule(rule + value, overrides)
    except RuleError as error:
        assert str(error)
    else:
        assert overrides


@settings(max_examples=300)
@given(YAML | VALUES.map(lambda each: f"n: {{ros__parameters: {each}}}") | VALUES)
def test_parameter_files_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    """A file sets scalars, lists of one type, or nothing."""
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    overrides = ParameterOverrides()
    try:
        read_file(str(path), overrides)
    except RuleError as error:
        assert str(error)
        return
    for name, value in overrides.matching("/n"):
        assert name
        if isinstance(value, list):
            assert value
            assert len({type(element) for element in value}) == 1
        else:
            assert value is None or isinstance(value, bool | int | float | str)


@given(st.binary(max_size=60))
def test_files_of_any_bytes_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, data: bytes
) -> None:
    """Files of any bytes get the same kinds of answers as files of text."""
    path = tmp_path_factory.getbasetemp() / "bytes.yaml"
    path.write_bytes(data)
    try:
        read_file(str(path), ParameterOverrides())
    except RuleError as error:
        assert str(error)


@given(
    st.lists(
        st.sampled_from(["--ros-args", "--", "-r", "-p", "--params-file", "--log-level", "-e", "a:=b", "x", "--enable-stdout-logs", ""])
        | RULES,
        max_size=8,
    )
)  # fmt: skip
def test_command_lines_are_read_or_refused(arguments: list[str]) -> None:
    """The arguments that are left for the program were there before, in the same order."""
    try:
        read = parse_arguments(arguments, warn=lambda _: None)
        left = rclpy_remove_ros_args(arguments)
    except (RuleError, UnknownROSArgsError) as error:
        assert str(error)
        return
    assert isinstance(read, Arguments)
    assert left == read.unparsed
    remaining = iter(arguments)
    assert all(each in remaining for each in left)


@given(st.integers(-(2**63), 2**63 - 1))
def test_integers_are_read_as_written(number: int) -> None:
    """Decimal and hexadecimal."""
    assert read_scalar(str(number)) == number
    assert read_scalar(hex(number)) == number


@given(st.floats(allow_nan=False, allow_infinity=False, allow_subnormal=False))
def test_floats_are_read_as_written(number: float) -> None:
    """Every normal double, and still a float."""
    read = read_scalar(repr(number))
    assert isinstance(read, float)
    assert read == number


@pytest.mark.parametrize(
    ("rule", "declared", "expected"),
    [
        (
            "wdth:=3",
            ["width"],
            "The parameter 'wdth' was given, but no node declared it: did you mean 'width'?",
        ),
        ("width:=3", ["width"], ""),
        ("wdth:=3", None, ""),
        ("arn:width:=3", ["width"], "Parameters for arn were given, but there was no such node: only /arm"),
        ("arm:width:=3", ["width"], ""),
        ("arm:w:=3", [], "The parameter 'w' was given, but no node declared it"),
    ],
)
def test_overrides_that_nobody_takes(rule: str, declared: list[str] | None, expected: str) -> None:
    overrides = ParameterOverrides()
    parse_override_rule(rule, overrides)
    overrides.use("/arm", declared)
    assert list(overrides.unused()) == ([expected] if expected else [])


def test_a_file_for_several_nodes_is_as_it_should_be(tmp_path: Path) -> None:
    """What it says for all, or for nodes elsewhere, is no mistake of this process."""
    file = tmp_path / "p.yaml"
    file.write_text(
        "/**: {ros__parameters: {a: 1}}\n/arm: {ros__parameters: {b: 1}}\n/leg: {ros__parameters: {c: 1}}\n"
    )
    overrides = ParameterOverrides()
    read_file(str(file), overrides)
    assert list(overrides.unused()) == []  # no node was made
    overrides.use("/arm", ["b"])
    assert list(overrides.unused()) == []


def test_endless_numbers_are_text() -> None:
    """Python refuses to read more than 4,300 digits; C finds them too large for any type."""
    assert read_scalar("1" * 5000) == "1" * 5000
    assert read_scalar("1" * 25) == float("1" * 25)
    assert read_scalar(f"0x1p-{'0' * 5000}1074") == f"0x1p-{'0' * 5000}1074"


@given(st.text(max_size=10))
def test_no_scalar_is_too_strange(text: str) -> None:
    """Every scalar that is neither a C number nor a boolean is the text itself."""
    value = read_scalar(text)
    assert type(value) in (bool, int, float, str)
    assert not isinstance(value, str) or value == text
    assert isinstance(value, str) or not math.isnan(value) or "nan" in text.lower()


@given(st.text("ab1_/~{}nods ", max_size=14))
def test_valid_names_expand_to_absolute_ones(name: str) -> None:
    """A valid name expands to an absolute one without substitutions, or names an unknown one."""
    if names.rclpy_get_validation_error_for_topic_name(name) is not None:
        with pytest.raises(ValueError, match="is invalid"):
            names.rclpy_expand_topic_name(name, "n", "/ns")
        return
    try:
        expanded = names.rclpy_expand_topic_name(name, "n", "/ns")
    except ValueError as error:
        assert "unknown substitution" in str(error)
    else:
        assert expanded.startswith("/")
        assert not set(expanded) & set("~{}")


def test_patterns_with_many_wildcards_are_matched_in_time(tmp_path: Path) -> None:
    """No pattern makes the matching explode."""
    path = tmp_path / "wild.yaml"
    path.write_text("/**" * 30 + "/x/**/x/**: {ros__parameters: {a: 1}}\n")
    overrides = ParameterOverrides()
    read_file(str(path), overrides)
    assert list(overrides.matching("/x" * 60 + "/y")) == [("a", 1)]
    assert not list(overrides.matching("/y" * 60))


def test_a_file_of_deep_nesting_is_read_or_refused(tmp_path: Path) -> None:
    """Deep nesting does not use the stack."""
    path = tmp_path / "deep.yaml"
    path.write_text("n: {ros__parameters: " + "{a: " * 3000 + "1" + "}" * 3000 + "}\n")
    overrides = ParameterOverrides()
    try:
        read_file(str(path), overrides)
    except RuleError as error:
        assert str(error)
    else:
        assert list(overrides.matching("/n")) == [(".".join("a" * 3000), 1)]


def test_errors_of_a_process_come_as_rcl_errors() -> None:
    """The error has the whole text, from the flag to the reason."""
    from rclpy.context import Context

    def init(*arguments: Any) -> None:
        Context().init(args=list(arguments))

    with pytest.raises(RCLError, match=r"Couldn't parse remap rule: '-r bad'\. Error: Expected lexeme type"):
        init("--ros-args", "-r", "bad")
    with pytest.raises(UnknownROSArgsError, match="'--nope'"):
        init("--ros-args", "--nope")
    with pytest.raises(TypeError):
        init("--ros-args", 1)


@pytest.mark.parametrize("args", [["program", "\udcc3"], ["--ros-args", "-r", "a:=\udcc3"]])
def test_arguments_without_utf8_are_refused(args: list[str]) -> None:
    with pytest.raises(UnicodeEncodeError):
        parse_arguments(args)
    with pytest.raises(UnicodeEncodeError):
        rclpy_remove_ros_args(args)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no such device")
def test_a_device_is_no_parameter_file() -> None:
    with pytest.raises(RuleError, match="larger than 64 MiB"):
        read_file("/dev/zero", ParameterOverrides())


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_is_a_parameter_file(tmp_path: Path) -> None:
    """As in bash's `--params-file <(...)`."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    text = b"/**: {ros__parameters: {gain: 0.1}}\n"
    thread = threading.Thread(target=pipe.write_bytes, args=(text,))
    thread.start()
    overrides = ParameterOverrides()
    read_file(str(pipe), overrides)
    thread.join()
    assert dict(overrides.matching("/n")) == {"gain": 0.1}
