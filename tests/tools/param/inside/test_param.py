"""`ifgen param`, against a node in this process."""

from __future__ import annotations

import json
from array import array
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
import rclpy
import yaml
from ifgen_runtime.parameters import parameter_yaml
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

from tests.cli.conftest import Run

ARM = "/robot/arm"
NAMES = """\
  any
  bytes
  count
  counts
  flag
  flags
  foo.bar.text
  foo.text
  gains
  name
  names
  speed
  start_type_description_service
  unset
  use_sim_time
"""


@pytest.fixture
def param(ifgen: Run, robot: Node) -> Run:
    return lambda *words: ifgen("param", *words)


def test_list(param: Run) -> None:
    assert param("list", ARM).out == NAMES
    everything = param("list").out
    assert everything.startswith(f"{ARM}:\n{NAMES}")
    assert "/_secret" not in everything
    assert "/mute" not in everything
    assert "/_secret:\n  start_type" in param("list", "--include-hidden-nodes").out


def test_list_some(param: Run) -> None:
    assert param("list", ARM, "--param-prefixes", "foo").out == "  foo.bar.text\n  foo.text\n"
    both = param("list", ARM, "--param-prefixes", "foo.bar", "foo", "--param-type").out
    assert both == "  foo.bar.text (type: string)\n  foo.text (type: string)\n"
    assert param("list", ARM, "--filter", "lag").out == ""
    assert param("list", ARM, "--filter", "fl.*s$").out == "  flags\n"
    assert param("list", "--filter", "nothing").out == ""
    assert param("list", ARM, "--filter", "gains", "--param-type").out == "  gains (type: double array)\n"
    assert json.loads(param("list", "--json", "--filter", "gains|sp").out)[ARM] == ["gains", "speed"]
    types = param("list", ARM, "--json", "--param-type").out
    assert json.loads(types)[ARM]["bytes"] == "byte array"
    assert json.loads(types)[ARM]["unset"] == "double"


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("flag", "Boolean value is: True"),
        ("count", "Integer value is: 3"),
        ("speed", "Double value is: 0.1"),
        ("foo.bar.text", "String value is: x"),
        ("bytes", "Byte values are: [b'a', b'\\xff']"),
        ("flags", "Boolean values are: [True, False]"),
        ("counts", "Integer values are: array('q', [1, 2])"),
        ("gains", "Double values are: array('d', [0.1, 2.5])"),
        ("names", "String values are: ['a', 'b']"),
    ],
)
def test_get(param: Run, name: str, shown: str) -> None:
    assert param("get", ARM, name).out == f"{shown}\n"
    assert param("get", "robot/arm", name, "--hide-type").out == shown.partition(": ")[2] + "\n"


def test_get_json(param: Run) -> None:
    expected = {"node": ARM, "name": "gains", "type": "double array", "value": [0.1, 2.5]}
    assert json.loads(param("get", ARM, "gains", "--json").out) == expected
    assert json.loads(param("get", ARM, "bytes", "--json").out)["value"] == [97, 255]


def test_set(param: Run, robot: Node) -> None:
    assert param("set", ARM, "speed", "0.2").out == "Set parameter successful\n"
    assert robot.get_parameter("speed").value == 0.2
    both = param("set", ARM, "counts", "[4, 5]", "any", "-1")
    assert both.out == "counts: Set parameter successful\nany: Set parameter successful\n"
    assert robot.get_parameter("any").value == -1
    assert list(robot.get_parameter("counts").value) == [4, 5]


def test_set_that_is_refused(param: Run, robot: Node) -> None:
    failed = param("set", ARM, "speed", "1", "flag", "false")
    assert (failed.code, failed.out) == (1, "flag: Set parameter successful\n")
    assert failed.err == (
        "speed: Setting parameter failed: "
        "Wrong parameter type, expected 'Type.DOUBLE' got 'Type.INTEGER'\n"
        "  = help: 'speed' has the type double: write a value such as 1.0\n"
    )
    failed = param("set", ARM, "sped", "1.0")
    assert failed.err.endswith("  = help: did you mean 'speed'?\n")
    failed = param("set", ARM, "--atomic", "speed", "0.5", "count", "5")
    assert failed.code == 1
    assert failed.err.startswith("Setting parameters atomically failed: ")
    assert robot.get_parameter("speed").value == 0.1
    assert param("set", ARM, "--atomic", "speed", "0.5").out == "Set parameters atomically successful\n"
    results = json.loads(param("set", ARM, "--json", "speed", "9.0").out)
    assert [(each["name"], each["successful"]) for each in results] == [("speed", False)]


def test_describe(param: Run) -> None:
    assert param("describe", ARM, "speed", "count").out == (
        "Parameter name: speed\n"
        "  Type: double\n"
        "  Description: in m/s\n"
        "  Constraints:\n"
        "    Min value: 0.0\n"
        "    Max value: 2.5\n"
        "    Step: 0.1\n"
        "Parameter name: count\n"
        "  Type: integer\n"
        "  Constraints:\n"
        "    Read only: true\n"
        "    Min value: 0\n"
        "    Max value: 10\n"
        "    Additional constraints: odd\n"
    )
    [found] = json.loads(param("describe", ARM, "speed", "--json").out)
    assert found["range"] == {"min": 0.0, "max": 2.5, "step": 0.1}


def test_delete(param: Run, robot: Node) -> None:
    assert param("delete", ARM, "any").out == "Deleted parameter successfully\n"
    assert not robot.has_parameter("any")
    failed = param("delete", ARM, "flag")
    assert (failed.code, failed.err) == (
        1,
        "Deleting parameter failed: Static parameter cannot be undeclared\n",
    )


def test_a_dump_can_be_loaded(param: Run, robot: Node, tmp_path: Path) -> None:
    text = param("dump", ARM).out
    values = yaml.safe_load(text)[ARM]["ros__parameters"]
    assert values["foo"] == {"bar": {"text": "x"}, "text": "5"}
    assert "bytes" not in values
    assert text.endswith("    #ifgen: bytes: [97, 255]\n\n")
    assert "unset" not in values
    everything = values | {"bytes": [97, 255]}
    assert json.loads(param("dump", ARM, "--json").out) == {ARM: {"ros__parameters": everything}}
    file = tmp_path / "arm.yaml"
    file.write_text(text.replace("speed: 0.1", "speed: 0.2"))
    robot.set_parameters([Parameter("bytes", Parameter.Type.BYTE_ARRAY, [])])
    loaded = param("load", ARM, file)
    assert (loaded.code, loaded.err) == (0, "")
    assert "Set parameter speed successful\n" in loaded.out
    assert "Set parameter count successful: it is read-only and has this value\n" in loaded.out
    assert robot.get_parameter("speed").value == 0.2
    assert robot.get_parameter("foo.text").value == "5"
    assert robot.get_parameter("bytes").value == [b"a", b"\xff"]


def test_load_of_wildcards_and_namespaces(param: Run, robot: Node, tmp_path: Path) -> None:
    file = tmp_path / "all.yaml"
    file.write_text(
        "/**: {ros__parameters: {speed: 0.3, name: all}}\n"
        "/other: {ros__parameters: {speed: 0.9}}\n"
        "robot: {arm: {ros__parameters: {name: mine, gains: []}}}\n"
    )
    assert param("load", ARM, file).code == 0
    assert (robot.get_parameter("speed").value, robot.get_parameter("name").value) == (0.3, "mine")
    assert list(robot.get_parameter("gains").value) == []
    param("set", ARM, "speed", "0.5")
    assert param("load", ARM, file, "--no-use-wildcard").code == 0
    assert robot.get_parameter("speed").value == 0.5


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "/b: {ros__parameters: {a: 1}}",
            "has no parameters for '/robot/arm' = help: it has parameters for: /b",
        ),
        ("{'", "it is no YAML: "),
        ("[1", "Sequences cannot be key at line 1 = help: it begins with the name of a node"),
        ("/robot/arm: {ros__parameters: {bytes: [1, 256]}}", "the value 256 in 'bytes' fits no byte"),
        ("5", "is no parameter file"),
        (
            "robot/arm: {ros__parameters: {speed: [1, a]}}",
            "line 1: the elements of a list have one type, but 'a' has another",
        ),
        ("robot/arm: {ros__parameters: {speed: fast}}", "Set parameter speed failed: Wrong parameter type"),
        (None, "cannot be read: No such file or directory"),
    ],
)
def test_files_that_are_wrong(param: Run, tmp_path: Path, text: str | None, told: str) -> None:
    if text is not None:
        (tmp_path / "p.yaml").write_text(text)
    failed = param("load", ARM, "p.yaml")
    assert failed.code == 1
    assert told in " ".join(failed.err.split())


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["get", "/robot/arn", "speed"], "there is no node '/robot/arn' = help: did you mean '/robot/arm'?"),
        (["list", "/x"], "there is no node '/x' = help: see `ifgen node list`"),
        (["get", "/robot/arn", "speed", "--timeout", "0"], "there is no node '/robot/arn'"),
        (["get", ARM, "sped"], "has no parameter 'sped' = help: did you mean 'speed'?"),
        (["get", ARM, "zzz"], "has no parameter 'zzz' = help: see `ifgen param list /robot/arm`"),
        (["get", ARM, "unset"], "the parameter 'unset' of '/robot/arm' has no value = help: it is declared"),
        (["describe", ARM, "speed", "zzz"], "has no parameter 'zzz'"),
        (["delete", ARM, "zzz"], "has no parameter 'zzz'"),
        (["set", ARM, "speed", "a: b: c"], "of 'speed' fits no parameter: this is a map"),
        (["set", ARM, "count", "99999999999999999999"], "write a value such as 1, of 64 bits"),
    ],
)
def test_mistakes(param: Run, words: list[str], told: str) -> None:
    failed = param(*words)
    assert failed.code == 1
    assert told in " ".join(failed.err.split())


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["set", ARM, "speed"], "every name needs a value after it"),
        (["set", ARM, "speed", "1", "--jsn"], "no such option '--jsn'"),
        (["list", "--filter", "("], "--filter '(' is no regular expression"),
    ],
)
def test_mistakes_on_the_command_line(param: Run, words: list[str], told: str) -> None:
    failed = param(*words)
    assert failed.code == 2
    assert told in " ".join(failed.err.split()).lower()


def test_a_node_without_services(param: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ifgen_tools.param.client._SERVICES_TAKE", 0.1)
    failed = param("get", "/mute", "speed")
    assert "error: the node '/mute' has no services for its parameters" in failed.err


def test_a_file_that_is_no_text(param: Run, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_bytes(b"/a:\n  \xff")
    done = param("load", ARM, "a.yaml")
    reason = 'unacceptable character #x00ff: invalid leading UTF-8 octet in "<byte string>", position 6'
    assert (done.code, done.err) == (1, f"error: a.yaml: it is no YAML: {reason}\n")


def test_a_node_that_answers_with_a_failure(param: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """As one that ends meanwhile."""

    def fail(self: AsyncParameterClient, names: list[str]) -> Any:
        future: Any = rclpy.Future()
        future.set_exception(ConnectionError("the server has gone"))
        return future

    monkeypatch.setattr(AsyncParameterClient, "get_parameters", fail)
    done = param("get", ARM, "speed")
    assert (done.code, done.err) == (
        1,
        f"error: the node '{ARM}' has not answered on 'get_parameters': the server has gone\n",
    )


KINDS: dict[str, list[Any]] = {
    "bool": [True, False],
    "int": [-(2**63), 2**63 - 1, 0],
    "double": [1e5, -0.0, float("nan"), float("-inf"), 5e-324, 0.1],
    "string": [
        "1e5",
        "nan",
        "y",
        "null",
        "2026-01-31",
        "12:30:45",
        "0x1F",
        "~",
        "007",
        "a\nb",
        "é",
        "",
        "a: b",
    ],
}


def test_every_value_comes_back(param: Run, robot: Node, tmp_path: Path) -> None:
    """By dump and load, by `set` of the text in the dump, and in a node that starts with the file."""
    values: dict[str, Any] = {f"{kind}s.all": many for kind, many in KINDS.items()}
    values |= {f"{kind}s.v{index}": each for kind, many in KINDS.items() for index, each in enumerate(many)}
    values |= {"some_bytes": [b"\0", b"\xff"], "bytes2": [b"y"]}
    for name, value in values.items():
        robot.declare_parameter(name, value, ParameterDescriptor(dynamic_typing=True))
    for kind, type_ in (
        ("no_numbers", Parameter.Type.DOUBLE_ARRAY),
        ("no_texts", Parameter.Type.STRING_ARRAY),
    ):
        robot.declare_parameter(kind, Parameter(kind, type_, []).value)
    names = [*values, "no_numbers", "no_texts"]

    def held(node: Node, names: Iterable[str]) -> dict[str, str]:
        found = {name: node.get_parameter(name).value for name in names}
        return {name: repr(list(each) if isinstance(each, array) else each) for name, each in found.items()}

    expected = held(robot, names)
    file = tmp_path / "arm.yaml"
    file.write_text(param("dump", ARM).out)

    def spoil() -> None:
        others = {name: [b"z"] if "bytes" in name else "other" for name in values}
        robot.set_parameters([Parameter(name, value=each) for name, each in others.items()])

    spoil()
    assert param("load", ARM, file).code == 0
    assert held(robot, names) == expected
    spoil()
    pairs = [
        (name, parameter_yaml.value_text(value)) for name, value in values.items() if "bytes" not in name
    ]
    assert param("set", ARM, *(word for pair in pairs for word in pair)).err == ""
    written = [name for name, _ in pairs]
    assert held(robot, written) == {name: expected[name] for name in written}
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "--params-file", str(file)], context=context)
    node = Node(
        "arm", namespace="/robot", context=context, automatically_declare_parameters_from_overrides=True
    )
    started = held(node, written)
    node.destroy_node()
    rclpy.shutdown(context=context)
    assert started == {name: expected[name] for name in written}
