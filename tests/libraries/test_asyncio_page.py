"""The examples of docs/asyncio.md print what the page says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

_PAGE = (Path(__file__).parents[2] / "docs/asyncio.md").read_text()
_FILE = re.compile(
    r"<!-- file: (\S+) -->\n```python\n(.*?)```\n\n```console\n\$ ifgen run \S+\n(.*?)```\n", re.DOTALL
)


@pytest.mark.parametrize(("name", "text", "output"), _FILE.findall(_PAGE), ids=lambda word: word[:12])
def test_an_example(name: str, text: str, output: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "local", name]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == output
    assert not ran.stderr
