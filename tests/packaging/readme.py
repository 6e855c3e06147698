"""The README as a script: its files are written and its commands run, in its order."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

README = Path(__file__).parents[2] / "README.md"
_STEP = re.compile(
    r"<!-- file: (?P<name>\S+) -->\n```\w*\n(?P<text>.*?)```\n|```console\n\$ (?P<command>.*?)\n.*?```\n",
    re.DOTALL,
)


def replayed(folder: Path, path: str, text: str | None = None) -> str:
    """The README with the output of its commands in this folder, with programs from `path` only."""
    return _STEP.sub(lambda match: _step(match, folder, path), text or README.read_text())


def _step(match: re.Match[str], folder: Path, path: str) -> str:
    """Write a file, or run a command and replace the output that is shown."""
    if match["name"]:
        file = folder / match["name"]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(match["text"])
        return match[0]
    environment = {k: v for k, v in os.environ.items() if k not in {"PYTHONPATH", "AMENT_PREFIX_PATH"}}
    environment |= {"PATH": path, "COLUMNS": "80", "NO_COLOR": "1"}
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
