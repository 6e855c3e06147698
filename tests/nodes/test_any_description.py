"""Every description that the reader accepts becomes formatted Python, and a node that starts."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import ifgen
import pytest
import yaml
from hypothesis import given, settings
from ifgen.nodl import schema
from ifgen.nodl.model import NodeDescription
from jsonschema import Draft7Validator

from .descriptions import OWN_MESSAGES, ROOT, descriptions, drawn, render, write

VALIDATOR = Draft7Validator(schema.schema())


@given(descriptions())
@settings(max_examples=15)
def test_all_of_it_is_python(node: NodeDescription) -> None:
    _compile_all(node)


@pytest.mark.slow
@given(descriptions())
@settings(max_examples=60)
def test_all_of_many_is_python(node: NodeDescription) -> None:
    _compile_all(node)


def _compile_all(node: NodeDescription) -> None:
    for path, text in render((node,)).items():
        if path.endswith(".py"):
            compile(text, path, "exec")


@given(descriptions())
@settings(max_examples=25)
def test_its_description_is_what_the_schema_says(node: NodeDescription) -> None:
    text = render((node,))[f"nodl/{node.name}.nodl.yaml"]
    assert [error.message for error in VALIDATOR.iter_errors(yaml.safe_load(text))] == []


STARTS = """
import importlib, rclpy
rclpy.init()
for number in range({count}):
    module = importlib.import_module(f"any_nodes.node{{number}}")
    getattr(module, f"Node{{number}}")().destroy_node()
rclpy.shutdown()
print("started")
"""


@pytest.mark.slow
def test_it_is_formatted_and_starts(tmp_path: Path) -> None:
    nodes = drawn(40)
    write(nodes, tmp_path / "generated")
    lint = (ROOT / "pyproject.toml").read_text()
    (tmp_path / "pyproject.toml").write_text(lint[lint.index("[tool.ruff]") : lint.index("[tool.mypy]")])
    for arguments in (
        ["format", "--diff"],
        ["check", "--no-cache", "--output-format", "concise", "--ignore", "D301,RUF001,RUF002"],
    ):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *arguments, tmp_path / "generated"],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout[-3000:]
    ifgen.generate(OWN_MESSAGES, output=tmp_path / "generated")
    program = tmp_path / "program.py"
    program.write_text(STARTS.format(count=len(nodes)))
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "run", "--transport", "local", program],
        capture_output=True, text=True, timeout=100, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert done.stdout == "started\n", done.stderr
