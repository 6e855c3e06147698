"""The README's files and commands, run in its order: what it shows is what one gets.

`IFGEN_RECORD=1 pytest tests/packaging/test_readme.py` writes what one gets into it.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

README = Path(__file__).parent.parent.parent / "README.md"
STEP = re.compile(
    r"<!-- file: (?P<name>\S+) -->\n```\w*\n(?P<text>.*?)```\n|```console\n\$ (?P<command>.*?)\n.*?```\n",
    re.DOTALL,
)


def test_commands_and_outputs(tmp_path: Path) -> None:
    shown = README.read_text()
    found = STEP.sub(lambda match: step(match, tmp_path), shown)
    if os.environ.get("IFGEN_RECORD"):
        README.write_text(found)
        return
    assert found == shown


def step(match: re.Match[str], folder: Path) -> str:
    """Write a file, or run a command and put its output in the place of the one shown."""
    if match["name"]:
        path = folder / match["name"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(match["text"])
        return match[0]
    commands = Path(sys.executable).parent
    environment = {k: v for k, v in os.environ.items() if k not in {"PYTHONPATH", "AMENT_PREFIX_PATH"}}
    environment |= {"PATH": f"{commands}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "80", "NO_COLOR": "1"}
    done = subprocess.run(
        match["command"],
        shell=True,
        cwd=folder,
        env={**environment, "XDG_CACHE_HOME": str(folder / "cache")},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    )
    return f"```console\n$ {match['command']}\n{done.stdout}```\n"


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
