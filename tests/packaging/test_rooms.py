"""The rooms of the toolkit are as docs/architecture.md draws them."""

from __future__ import annotations

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


def test_no_room_is_crowded() -> None:
    rooms = Counter(path.parent for path in (ROOT / "codegen/ifgen").rglob("*.py"))
    assert {room: size for room, size in rooms.items() if size > 20 + 1} == {}  # and its __init__.py
