"""YAML written from any texts: every reader understands it, and every value arrives unchanged."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from ifgen.generator_py.nodes.parameters import config_lines
from ifgen.nodl.model import NodeDescription, Parameter, ParameterType
from ifgen.nodl.yaml_lines import description_lines
from ifgen_tools.nodl.document import as_yaml, document_of
from ifgen_tools.nodl.parameters import RunningParameter

from .conftest import load_from

ROOT = Path(__file__).parents[2]
BEYOND = [0x10000, 0x1F600, 0x1FFFE, 0xE0001, 0xFFFFF, 0x10FFFF]
CHARACTERS = [chr(code) for code in (*range(1, 0xD800), *range(0xE000, 0x10000), *BEYOND)]
"""What a string of ROS can hold: the Basic Multilingual Plane without NUL, and some beyond it."""
ODD = [c for c in CHARACTERS if c < "\u0300" or "\u2000" <= c < "\u2100" or c > "\ufdcf"]
"""The blocks in which there are others than letters and signs."""

VALUES: dict[str, str | list[str]] = {
    "all": "".join(CHARACTERS),
    "apart": "a".join(CHARACTERS),
    **{f"odd{number}": [f"a{c}b", f"{c}x{c} {c}"] for number, c in enumerate(ODD)},
}


NO_MORE: Any = (False, "", None, 0)
"""What a descriptor says that says nothing: read-only, constraints, range, step."""


def node() -> NodeDescription:
    """A node whose parameters have these values, with the values in their descriptions too."""
    parameters = [
        Parameter(name, ParameterType("string"), value, value)
        if isinstance(value, str)
        else Parameter(name, ParameterType("string", array=True), tuple(value), value[1])
        for name, value in VALUES.items()
    ]
    return NodeDescription(
        "demo",
        "talker",
        "".join(CHARACTERS),
        "callbacks",
        "Talker",
        "talker.py",
        tuple(parameters),
        (),
        (),
        (),
        (),
        (),
        (),
    )


def python(text: str) -> Any:
    """PyYAML's reading of the text."""
    return yaml.safe_load(text.encode())


def libyaml(text: str) -> Any:
    """The reading of the parser of ROS, through PyYAML."""
    return yaml.load(text.encode(), yaml.CSafeLoader)


READERS = [
    pytest.param(python, marks=pytest.mark.slow),
    pytest.param(
        libyaml, marks=pytest.mark.skipif(not hasattr(yaml, "CSafeLoader"), reason="PyYAML without libyaml")
    ),
]


@pytest.fixture(scope="module")
def parameter_file() -> str:
    return "\n".join(["/**/talker:", "  ros__parameters:", *config_lines(node())]) + "\n"


@pytest.mark.parametrize("reader", READERS)
def test_a_parameter_file(reader: Callable[[str], Any], parameter_file: str) -> None:
    assert reader(parameter_file)["/**/talker"]["ros__parameters"] == VALUES


@pytest.mark.parametrize("reader", READERS)
def test_a_description(reader: Callable[[str], Any]) -> None:
    document = reader("\n".join(["nodl_version: 2", *description_lines(node())]))
    assert document["description"] == VALUES["all"]
    assert {name: said["default_value"] for name, said in document["parameters"].items()} == VALUES


@pytest.mark.parametrize("reader", READERS)
def test_what_is_described_of_a_running_node(reader: Callable[[str], Any]) -> None:
    seen = [
        RunningParameter(
            name, "string" if isinstance(value, str) else "string_array", value, value[0], *NO_MORE
        )
        for name, value in VALUES.items()
    ]
    document, omitted = document_of("/talker", (), seen)
    assert not omitted
    read = reader(as_yaml(document, ["parameter '\x81\ufffe\u2028\x85'"]))["parameters"]
    assert {name: said["default_value"] for name, said in read.items()} == VALUES
    assert {name: said["description"] for name, said in read.items()} == {
        name: value[0] for name, value in VALUES.items()
    }


def test_we_read_what_we_write(tmp_path: Path) -> None:
    lines = "\n".join(["nodl_version: 2", *description_lines(node())]).splitlines()[:2]
    read = load_from(tmp_path, {"demo/nodl/talker.nodl.yaml": "\n".join(lines)}).node
    assert read.description == VALUES["all"]


PROGRAM = """
import json, sys
import rclpy
from rclpy.node import Node

rclpy.init(args=["--ros-args", "--params-file", sys.argv[1]])
node = Node("talker", automatically_declare_parameters_from_overrides=True)
json.dump({name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}, sys.stdout)
rclpy.shutdown()
"""


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_a_node_gets_every_value(transport: str, parameter_file: str, tmp_path: Path) -> None:
    """The values arrive through its parameter file, with the parser of ROS too."""
    if transport == "rclpy" and importlib.util.find_spec("rclpy") is None:
        pytest.skip("there is no real rclpy")
    file, program = tmp_path / "talker.yaml", tmp_path / "talker.py"
    file.write_text(parameter_file, encoding="utf-8")
    program.write_text(PROGRAM)
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, str(program), str(file)]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=60, cwd=ROOT, env=os.environ, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert {name: found[name] for name in VALUES} == VALUES
