"""The README as a script: its files are written and its commands run, in its order."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from contextlib import ExitStack
from pathlib import Path

README = Path(__file__).parents[2] / "README.md"
_STEP = re.compile(
    r"<!-- file: (?P<name>\S+) -->\n```\w*\n(?P<text>.*?)```\n"
    r"|<!-- terminal -->\n```sh\n(?P<meanwhile>.*?)\n```\n"
    r"|```console\n\$ (?P<command>.*?)\n.*?```\n",
    re.DOTALL,
)


def replayed(folder: Path, path: str, text: str | None = None) -> str:
    """The README with the output of its commands in this folder, with programs from `path` only."""
    with ExitStack() as terminals:
        return _STEP.sub(lambda match: _step(match, folder, path, terminals), text or README.read_text())


def _step(match: re.Match[str], folder: Path, path: str, terminals: ExitStack) -> str:
    """Write a file, start a command in another terminal, or run one and replace the output that is shown."""
    if match["name"]:
        file = folder / match["name"]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(match["text"])
        return match[0]
    environment = {k: v for k, v in os.environ.items() if k not in {"PYTHONPATH", "AMENT_PREFIX_PATH"}}
    environment |= {"PATH": path, "COLUMNS": "80", "NO_COLOR": "1"}
    if match["meanwhile"]:
        process = subprocess.Popen(match["meanwhile"].split(), cwd=folder, env=environment)
        terminals.callback(process.wait, 30)
        terminals.callback(process.send_signal, signal.SIGINT)
        return match[0]
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
