"""The files and commands of the README and of pages in docs, run in order: the output that they show is what users get.

`IFGEN_RECORD=1 pytest tests/packaging/test_readme.py` writes the present output into them.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from .readme import README, replayed

_DOCS = README.parent / "docs"
PAGES = {page.name: page for page in (README, _DOCS / "numpy.md", _DOCS / "tools.md")}
_SLOW = {"tools.md"}  # a process for each of its many commands


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in _SLOW else []) for name in PAGES]
)
def test_commands_and_outputs(tmp_path: Path, name: str) -> None:
    shown = PAGES[name].read_text()
    found = replayed(tmp_path, f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}", shown)
    if os.environ.get("IFGEN_RECORD"):
        PAGES[name].write_text(found)
        return
    assert found == shown


def test_links_lead_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)", README.read_text())
    assert links
    assert not [link for link in links if not link.startswith("http") and not (README.parent / link).exists()]


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_make_help_names_the_readmes_targets() -> None:
    found = subprocess.run(
        ["make", "help"], cwd=README.parent, capture_output=True, text=True, check=True
    ).stdout
    for target in re.findall(r"^make (\w+)", README.read_text(), re.MULTILINE):
        assert f"make {target} " in found
