"""The document in a generated package says the same as its source with its includes, and can be read back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from ifgen import generate, resources
from ifgen.nodl.load import load
from ifgen.nodl.model import NodeDescription, Nodes
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

EXAMPLES = Path(__file__).parent / "examples"


def nodes_in(*paths: Path, include: Path | None = None) -> Nodes:
    packages = find_packages(paths)
    return load(packages, SearchPath(packages, [include] if include else []))


def public(node: NodeDescription) -> NodeDescription:
    """NoDL's own part of a description: without `codegen`, and validators without functions."""
    parameters = (
        replace(p, validators=tuple(replace(v, function=None) for v in p.validators)) for p in node.parameters
    )
    return replace(
        node,
        style="callbacks",
        node_class="",
        business_file="",
        timers=(),
        tests=None,
        parameters=tuple(parameters),
    )


def test_round_trip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The round trip works for the examples and for every node that comes with ifgen."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    source = tmp_path / "examples/examples_of_nodl/nodl"
    source.mkdir(parents=True)
    for path in EXAMPLES.iterdir():
        (source / path.name).write_text(path.read_text())
    given = [
        tmp_path / "examples",
        *(p.parent for p in sorted(resources.bundled_interfaces().glob("*/nodl"))),
    ]
    generate(*given, output=tmp_path / "generated")
    written = nodes_in(*given)
    for path in (tmp_path / "generated").glob("*/nodl/*.nodl.yaml"):
        if "::" in path.read_text():  # the functions of these are named under codegen, which is left out
            functions = "codegen: {ifgen: {validators: {'humanoid_checks::odd_joint_count': a.b}}}\n"
            path.write_text(path.read_text() + functions)
    for manifest in (tmp_path / "generated").glob("*/.ifgen-manifest.json"):
        manifest.unlink()  # otherwise the package does not count as a source
    again = nodes_in(tmp_path / "generated", include=resources.bundled_interfaces())
    before = [public(node) for package in written.packages for node in package.nodes]
    after = [public(node) for package in again.packages for node in package.nodes]
    assert len(after) >= 2
    assert after == before
