"""The rooms of the toolkit are as docs/architecture.md draws them."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_and_the_contract_have_the_same_floors() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    contracts = project["tool"]["importlinter"]["contracts"]
    page = (ROOT / "docs/architecture.md").read_text()
    plan = page.partition("## 3. ")[2].partition("```\n")[2].partition("```")[0]
    assert plan.splitlines() == next(c["layers"] for c in contracts if c["type"] == "layers")


def test_each_room_has_its_line_on_the_page() -> None:
    page = (ROOT / "docs/architecture.md").read_text().partition("## 2. ")[2].partition("## 3. ")[0]
    folders = [path for path in sorted((ROOT / "codegen/ifgen").iterdir()) if (path / "__init__.py").exists()]
    lines = re.findall(r"^    (\w+)/  ", page, re.MULTILINE)
    assert [folder.name for folder in folders if folder.name not in lines] == []


def test_the_pictures_are_up_to_date() -> None:
    command = [sys.executable, str(ROOT / "docs/pictures.py"), "--check"]
    checked = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (checked.stdout, checked.stderr, checked.returncode) == ("", "", 0)


def test_the_list_of_modules_has_a_sentence_for_each() -> None:
    command = [sys.executable, str(ROOT / "docs/modules.py"), "ifgen/pipeline"]
    listed = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (listed.stderr, listed.returncode) == ("", 0)
    assert re.search(r"^  stages +The work of ifgen", listed.stdout, re.MULTILINE)


def test_no_room_is_crowded() -> None:
    rooms = Counter(path.parent for path in (ROOT / "codegen").rglob("*.py"))
    crowds = {str(room.relative_to(ROOT / "codegen")) for room, size in rooms.items() if size > 20 + 1}
    # In rclpy the modules are upstream's, and so is their number in C.
    assert crowds == {"underlay/rclpy", "underlay/rclpy/impl/rcl"}


SMALL = {
    "ifgen.command_kit.failures": "only a run that fails loads it",
    "ifgen.idl.omg_recovery": "only a file with wrong syntax needs it, as `omg_explain`",
    "ifgen.pipeline.typings": "`ifgen typings` as `stages` is `ifgen generate`",
    "ifgen.reading.python_text": "places in Python, beside those in the other kinds of files that are read",
    "ifgen_generators.rust.testee": "code for tests, which users do not get",
    "ifgen_runtime.importing": "messages load it, and must stay light",
    "ifgen_tools.system.running": "`ifgen doctor` finds it by the group `ifgen.system`",
}
"""Modules of fewer than 60 lines that one other imports, and why they stand by themselves."""


def test_small_modules_have_a_reason() -> None:
    """Those of rclpy and of libraries have upstream's names."""
    command = [sys.executable, str(ROOT / "docs/figures.py"), "--small"]
    listed = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    names = {line.split()[1] for line in listed.stdout.splitlines()}
    rooms = ("ifgen", "ifgen_pytest", "ifgen_runtime", "ifgen_tools", "rmw_local")
    ours = {name for name in names if name.startswith(rooms) or "._" in name or ".impl." in name}
    assert ours == set(SMALL)


def test_what_the_walks_name_is_there() -> None:
    page = (ROOT / "docs/architecture.md").read_text().partition("## 5. ")[2]
    steps = re.findall(r"^\d+\. `([^`]+)`", page, re.MULTILINE)
    assert len(steps) == 12 + 9
    folders = (ROOT, ROOT / "codegen/ifgen", ROOT / "codegen/underlay")
    assert [step for step in steps if not any((folder / step).is_file() for folder in folders)] == []


def test_what_contributors_are_to_open_is_there() -> None:
    table = (
        (ROOT / "CONTRIBUTING.md")
        .read_text()
        .partition("| to change | open | its test |\n|---|---|---|\n")[2]
    )
    rows = [line.split("|")[2:4] for line in table.partition("\n\n")[0].splitlines()]
    assert len(rows) >= 25
    for cells in rows:
        for cell, folder in zip(cells, ("codegen", "tests"), strict=True):
            for name in re.findall(r"`([^`]+)`", cell):
                assert (ROOT / name if name.startswith("docs/") else ROOT / folder / name).exists(), name


def test_each_library_is_in_the_contracts_and_on_its_page() -> None:
    libraries = [path.parent.name for path in sorted((ROOT / "codegen/libraries").glob("*/__init__.py"))]
    assert libraries
    linter = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    contracts = {contract["name"]: contract for contract in linter["contracts"]}
    page = (ROOT / "docs/libraries.md").read_text()
    for name in libraries:
        assert name in linter["root_packages"]
        assert name in contracts["libraries stand on rclpy's public API"]["source_modules"]
        assert name in contracts["nothing of ours needs the libraries"]["forbidden_modules"]
        assert f"| `{name}` |" in page
        assert (ROOT / "codegen/libraries" / name / "py.typed").exists()
