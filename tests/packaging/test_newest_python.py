"""The choice of a second Python that CI tests with."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / ".ci" / "newest_python.py"


def python(folder: Path, name: str, said: str, code: int = 0) -> None:
    """Put a program on the PATH that answers every question in the same way."""
    folder.mkdir(exist_ok=True, parents=True)
    path = folder / name
    path.write_text(f"#!/bin/sh\necho '{said}'\nexit {code}\n")
    path.chmod(0o755)


@pytest.mark.skipif(sys.platform == "win32", reason="scripts with #!")
def test_the_newest_that_is_newer_and_supported(tmp_path: Path) -> None:
    folder = tmp_path / "bin"
    minor = sys.version_info.minor
    python(folder, "python3.10", "3 10 9 cpython")
    python(folder, "python3.99", "3 99 0 cpython")
    python(folder, "python3.14-config", "3 14 3 cpython")
    python(folder, "python3.9", "", code=1)  # no ensurepip
    environment = {"PATH": str(folder), "HOME": str(tmp_path)}

    def newest() -> str:
        command = [sys.executable, SCRIPT]
        return subprocess.check_output(command, env=environment, text=True, timeout=60).strip()

    assert newest() == ""
    if minor < 14:
        python(folder, f"python3.{minor + 1}", f"3 {minor + 1} 0 pypy")
        assert newest() == ""
        for patch in (2, 10, 3):
            python(tmp_path / f".pyenv/versions/{patch}/bin", "python3.14", f"3 14 {patch} cpython")
        assert newest() == str(tmp_path / ".pyenv/versions/10/bin/python3.14")
