"""Projects with a target, and the programs of docs pages."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parents[2]
SUITE: Final = ROOT / "tests/conformance"
ALL: Final = (ROOT / "interfaces", SUITE / "interfaces")
TSCONFIG: Final = {
    "strict": True,
    "target": "es2022",
    "module": "nodenext",
    "lib": ["es2024", "dom"],
    "erasableSyntaxOnly": True,
    "noUncheckedIndexedAccess": True,
    "verbatimModuleSyntax": True,
    "types": [],
}


def generate(
    folder: Path, generator: str, out: str, *paths: Path, only: Sequence[str] = (), **options: Any
) -> Path:
    """Run `ifgen generate` with one target in a project, and return the folder of its files."""
    values = ", ".join(f"{key} = {_toml(value)}" for key, value in options.items())
    names = ", ".join(f'"{path}"' for path in paths)
    (folder / "pyproject.toml").write_text(
        f"[tool.ifgen]\npaths = [{names}]\npython = false\n"
        f'[tool.ifgen.generate.code]\nuse = "{generator}"\nout = "{out}"\noptions = {{ {values} }}\n'
        f"only = {_toml(list(only))}\n"
    )
    command = [sys.executable, "-m", "ifgen", "generate", "--quiet"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    return folder / out


def _toml(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return str(value).lower() if isinstance(value, bool) else f'"{value}"'


def example_of(page: str, folder: Path) -> Mapping[str, str]:
    """The last block of each language in a page; its `.msg` file is written to a folder first."""
    text = (ROOT / "docs" / page).read_text()
    definition, file = re.findall(r"echo '(.*?)' > (\S+)", text, re.DOTALL)[0]
    (folder / file).parent.mkdir(parents=True)
    (folder / file).write_text(definition + "\n")
    return {
        language or "output": block for language, block in re.findall(r"```(\w*)\n(.*?)```", text, re.DOTALL)
    }


def run(command: Sequence[str], folder: Path) -> str:
    """The output of a program that has to end well."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=280, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return done.stdout


def write_traps(folder: Path) -> Path:
    """The interfaces with every trap, which authors of generators test with."""
    run(
        [sys.executable, "-m", "ifgen", "generators", "test", "json-schema", "--corpus", str(folder)],
        folder.parent,
    )
    return folder
