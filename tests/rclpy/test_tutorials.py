"""Programs as today's tutorials describe them run unchanged, with each profile, apart and in one process."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

TEXT = Path(__file__).with_name("tutorials.txt").read_text(encoding="utf-8")
LIMIT = 60.0  # [s] for one of them


@dataclass(frozen=True)
class Tutorial:
    """One program, what it prints, and the programs beside it."""

    name: str
    expected: list[str]
    programs: list[str]


def _tutorials() -> dict[str, Tutorial]:
    sections = re.split(r"^=== (\w+) > (.*)\n", TEXT, flags=re.MULTILINE)[1:]
    found = {}
    for name, expected, text in zip(sections[::3], sections[1::3], sections[2::3], strict=True):
        found[name] = Tutorial(name, expected.split(" | "), text.split("--- beside\n"))
    return found


TUTORIALS = _tutorials()


def run(words: list[str], folder: Path, profile: str) -> str:
    """Run `ifgen run`; returns what it prints on stdout. What it says on stderr is no traceback."""
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "run", "--transport", "local", "--ros-distro", profile, *words],
        cwd=folder,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert "real Kilted will refuse" not in done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["kilted", "lyrical"])
@pytest.mark.parametrize("name", TUTORIALS)
def test_apart(name: str, profile: str, tmp_path: Path) -> None:
    tutorial = TUTORIALS[name]
    files = [f"program_{index}.py" for index in range(len(tutorial.programs))]
    for file, text in zip(files, tutorial.programs, strict=True):
        (tmp_path / file).write_text(text)
    first, *others = files
    # The last one ends the others.
    words = [word for file in [*others, first] for word in (file, ":")][:-1]
    assert run(words, tmp_path, profile).splitlines() == tutorial.expected


_TOGETHER = """
import json, pathlib, sys
for text in json.loads(pathlib.Path("programs.json").read_text()):
    exec(compile(text, "program", "exec"), {"__name__": "__main__"})
"""


@pytest.mark.parametrize("profile", [pytest.param("kilted", marks=pytest.mark.slow), "lyrical"])
def test_in_one_process(profile: str, tmp_path: Path) -> None:
    """One after the other, each with `init` and the end of its block."""
    import json

    alone = [each for each in TUTORIALS.values() if len(each.programs) == 1]
    assert len(TUTORIALS) >= 20
    (tmp_path / "programs.json").write_text(json.dumps([each.programs[0] for each in alone]))
    (tmp_path / "all.py").write_text(_TOGETHER)
    expected = [line for each in alone for line in each.expected]
    assert run(["all.py"], tmp_path, profile).splitlines() == expected
