"""Generated tests pass for packages and nodes as users write them, drawn at random but always the same."""

from __future__ import annotations

from pathlib import Path

import ifgen
import pytest

from ..nodes import descriptions
from ..nodes.descriptions import one
from . import definitions
from .behaviours import ordinary
from .running import on_both, run


def write_packages(count: int, folder: Path) -> None:
    """Generate the given number of interface packages, and their tests."""
    for number in range(count):
        definitions.write(one(definitions.packages(), number), folder / f"interfaces/drawn{number}_msgs")
    ifgen.generate(folder / "interfaces", output=folder / "generated")


def write_nodes(count: int, folder: Path) -> None:
    """Generate the given number of nodes and their tests, and write ordinary code into their callbacks."""
    nodes = descriptions.drawn(count)
    package = descriptions.write(nodes, folder / "generated")
    ifgen.generate(descriptions.OWN_MESSAGES, output=folder / "generated")
    for number, node in enumerate(nodes):
        module = package / "any_nodes" / node.business_file
        module.write_text(one(ordinary(node, module.read_text()), number))
        (package / f"test/test_{node.name}.py").unlink()  # that test is about the behaviour of a new node


def test_some_interfaces_pass(tmp_path: Path) -> None:
    write_packages(3, tmp_path)
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    assert failed == {f"drawn{number}_msgs": set() for number in range(3)}, output


@pytest.mark.slow
@pytest.mark.timeout(900)
@on_both
def test_a_hundred_interface_packages_pass(tmp_path: Path, transport: str) -> None:
    write_packages(100, tmp_path)
    arguments = [f"--transport={transport}"]
    failed, output = run(tmp_path, *arguments, path=[tmp_path / "generated"], limit=800.0)
    assert failed == {f"drawn{number}_msgs": set() for number in range(100)}, output


@pytest.mark.slow
def test_some_nodes_pass_whatever_their_callbacks_do(tmp_path: Path) -> None:
    write_nodes(4, tmp_path)  # of each style
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    assert failed == {"any_nodes": set(), "own_msgs": set()}, output


@pytest.mark.slow
@pytest.mark.timeout(900)
@on_both
def test_thirty_nodes_pass_whatever_their_callbacks_do(tmp_path: Path, transport: str) -> None:
    write_nodes(30, tmp_path)
    arguments = [f"--transport={transport}"]
    failed, output = run(tmp_path, *arguments, path=[tmp_path / "generated"], limit=800.0)
    assert failed == {"any_nodes": set(), "own_msgs": set()}, output
