"""New names at random: nothing breaks that was whole, and hashes change only where they must."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest

pytest.importorskip("pygls")

import ifgen
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.references import references
from ifgen.definition.type_description import TypeHashes
from ifgen.diagnostics import Span
from ifgen.language_server import rename
from ifgen.language_server.symbols import Symbol
from ifgen.language_server.workspace import Workspace, parts_of

ROOT = Path(__file__).parents[2]
PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "tf2_msgs", "visualization_msgs")


def hashes(registry: Registry) -> dict[str, str]:
    """The hash of each type of the workspace."""
    known = TypeHashes(registry)
    requested = [registry.packages[name] for name in registry.requested]
    return {each.type_name: known.of(each) for package in requested for each in package.interfaces}


def any_symbol(workspace: Workspace, chance: random.Random) -> Symbol:
    """A type, field or constant of the workspace."""
    registry = workspace.registry()
    package = registry.packages[chance.choice(registry.requested)]
    interface = chance.choice(package.interfaces)
    assert interface.source is not None
    nowhere = Span(interface.source, 0, 0)
    part = chance.choice(parts_of(interface))
    members = [
        *(Symbol("field", part.type_name, nowhere, each.name) for each in part.fields),
        *(Symbol("constant", part.type_name, nowhere, each.name) for each in part.constants),
    ]
    if chance.random() < 0.4 or not members:
        return Symbol("type", interface.type_name, nowhere)
    return chance.choice(members)


def users(registry: Registry, name: str) -> set[str]:
    """The types that hold a type, directly or not, and itself."""
    found = {name}
    while True:
        more = {
            each.type_name
            for package in registry.packages.values()
            for each in package.interfaces
            for part in parts_of(each)
            for _, held in references(part)
            if held.type_name in found
        }
        if more <= found:
            return found
        found |= more


def applied(workspace: Workspace, renaming: rename.Renaming) -> None:
    """Change the files as an editor would."""
    for path, edits in renaming.edits.items():
        source = workspace.source(path)
        assert source is not None
        path.write_text(rename.edited(source, edits.values()))
    for old, new in renaming.moves.items():
        old.rename(new)


@pytest.mark.parametrize("number", [3, pytest.param(100, marks=[pytest.mark.slow, pytest.mark.timeout(900)])])
def test_random_renames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    for package in PACKAGES:
        shutil.copytree(ROOT / "interfaces" / package, tmp_path / package)
    monkeypatch.chdir(tmp_path)
    chance = random.Random(number)
    workspace = Workspace(tmp_path)
    for turn in range(number):
        before = hashes(workspace.registry())
        symbol = any_symbol(workspace, chance)
        new = {"type": f"Renamed{turn}", "field": f"renamed{turn}", "constant": f"RENAMED{turn}"}[symbol.kind]
        touched = users(workspace.registry(), owner(workspace, symbol))
        renaming = rename.renaming_of(workspace, symbol, new)
        applied(workspace, renaming)
        workspace.files_changed()
        assert [each for each in workspace.all_findings() if each.severity == "error"] == []
        after = hashes(workspace.registry())
        lost = before.keys() - after.keys()
        assert lost == ({symbol.type_name} if symbol.kind == "type" else set())
        changed = {name for name in before.keys() & after.keys() if before[name] != after[name]}
        expected = set[str]() if symbol.kind == "constant" else touched & after.keys() & before.keys()
        assert changed == expected
    done = ifgen.generate(tmp_path, output=tmp_path / "generated")
    for path in done.written:
        if path.suffix == ".py":
            compile(path.read_text(), str(path), "exec")


def owner(workspace: Workspace, symbol: Symbol) -> str:
    """The interface that has a symbol."""
    if isinstance(workspace.registry().get(symbol.type_name), Message) or symbol.kind == "type":
        return symbol.type_name
    return symbol.type_name.rpartition("_")[0]


def test_a_package_is_renamed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for package in PACKAGES:
        shutil.copytree(ROOT / "interfaces" / package, tmp_path / package)
        (tmp_path / package / "CMakeLists.txt").unlink(missing_ok=True)
    monkeypatch.chdir(tmp_path)
    workspace = Workspace(tmp_path)
    before = hashes(workspace.registry())
    interface = workspace.interface("geometry_msgs/msg/Pose")
    assert interface is not None and interface[0].source is not None
    symbol = Symbol("package", "geometry_msgs/msg/Pose", Span(interface[0].source, 0, 0))
    renaming = rename.renaming_of(workspace, symbol, "shape_msgs2")
    assert renaming.moves == {tmp_path / "geometry_msgs": tmp_path / "shape_msgs2"}
    applied(workspace, renaming)
    workspace.files_changed()
    assert [each for each in workspace.all_findings() if each.severity == "error"] == []
    after = hashes(workspace.registry())
    assert after.keys() == {name.replace("geometry_msgs/", "shape_msgs2/") for name in before}
    assert after["std_msgs/msg/Header"] == before["std_msgs/msg/Header"]
    assert after["sensor_msgs/msg/Imu"] != before["sensor_msgs/msg/Imu"]
