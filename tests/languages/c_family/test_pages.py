"""The five minutes of docs/cpp.md and docs/c.md, as a reader would run them."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from ...conformance.support import tool
from .support import ROOT, run

_FILE = re.compile(r"`([\w./]+)`[^`]*?:\n\n```\w*\n(.*?)```", re.DOTALL)
_SESSION = re.compile(r"```\n(\$ ifgen generate\n.*?)```", re.DOTALL)


@pytest.mark.parametrize(("page", "compiler"), [("cpp", "g++"), ("c", "gcc")])
def test_the_example_prints_what_the_page_shows(tmp_path: Path, page: str, compiler: str) -> None:
    tool(compiler)
    text = (ROOT / f"docs/{page}.md").read_text("utf-8")
    files = _FILE.findall(text.partition("\n## What there is")[0])
    assert [name for name, _ in files] == [
        "interfaces/demo_msgs/msg/Reading.msg",
        "pyproject.toml",
        f"main.{page}",
    ]
    for name, content in files:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, "utf-8")
    session = _SESSION.search(text)
    assert session is not None
    commands = [line[2:] for line in session[1].splitlines() if line.startswith("$ ")]
    shown = [line for line in session[1].splitlines() if not line.startswith("$ ")]
    assert commands[0] == "ifgen generate"
    run([sys.executable, "-m", "ifgen", "generate"], tmp_path)
    for command in commands[1:-1]:
        run([*shlex.split(command), "-Werror"], tmp_path)
    assert run([str(tmp_path / "main")], tmp_path).splitlines() == shown
