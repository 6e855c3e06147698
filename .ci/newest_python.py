"""Prints the path of the newest CPython here, if it is newer than the one that runs this."""

import os
import re
import subprocess
import sys
from pathlib import Path

NEWEST = (3, 14)  # that ifgen says it supports
VERSION = "import ensurepip, sys; print(*sys.version_info[:3], sys.implementation.name)"


def main() -> None:
    """Ask each `python3.N` on the PATH and of pyenv for its version."""
    folders = [Path(entry) for entry in os.get_exec_path()]
    folders += Path.home().glob(".pyenv/versions/*/bin")
    found = {}
    for folder in folders:
        for path in folder.glob("python3.*"):
            if re.fullmatch(r"python3\.\d+", path.name) and (version := asked(path)):
                found.setdefault(version, path)
    newer = [version for version in found if sys.version_info[:2] < version[:2] <= NEWEST]
    if newer:
        print(found[max(newer)])


def asked(python: Path) -> tuple[int, ...] | None:
    """The version of a CPython that can make environments; None for anything else."""
    try:
        said = subprocess.run(
            [python, "-c", VERSION], capture_output=True, text=True, check=False
        ).stdout.split()
    except OSError:
        return None
    return tuple(map(int, said[:3])) if said[3:] == ["cpython"] else None


if __name__ == "__main__":
    main()
