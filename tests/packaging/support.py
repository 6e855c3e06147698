"""Build distributions, and make environments that know nothing about this repository."""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import venv
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


def attempt(*command: str | Path, cwd: Path, limit: float = 110) -> subprocess.CompletedProcess[str]:
    """Run a command with its own cache and without this environment."""
    hidden = {"PYTHONPATH", "AMENT_PREFIX_PATH"}
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    environment |= {"XDG_CACHE_HOME": str(cwd / "cache"), "COLUMNS": "80"}
    return subprocess.run(
        list(map(str, command)),
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=limit,
        check=False,
    )


def run(*command: str | Path, cwd: Path, limit: float = 110) -> str:
    """The output of a command, which must succeed within the given number of seconds."""
    found = attempt(*command, cwd=cwd, limit=limit)
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


@contextmanager
def building() -> Generator[None]:
    """Wait for one's turn: setuptools writes beside the sources, where other workers may be building."""
    checkout = hashlib.sha256(str(ROOT).encode()).hexdigest()[:16]
    with (Path(tempfile.gettempdir()) / f"ifgen-building-{checkout}").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def build(source: Path, output: Path, kind: str) -> Path:
    """A wheel or an sdist, built without a network."""
    before = set(output.iterdir())
    words = ("-m", "build", "--no-isolation", f"--{kind}", "--outdir", output, source)
    with building():
        run(sys.executable, *words, cwd=output)
    [built] = set(output.iterdir()) - before
    return built


def unpacked(sdist: Path, folder: Path) -> Path:
    """The folder inside an sdist."""
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    return folder / sdist.name.removesuffix(".tar.gz")


def environment(folder: Path, *wheels: Path, behind: Path | None = None) -> Path:
    """An interpreter that has the wheels, and after them the packages of this one, or those in a folder."""
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    if wheels:
        install(python, "--no-deps", "--no-index", *wheels)
    site = Path(
        run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder).strip()
    )
    (site / "dependencies.pth").write_text(f"{behind or sysconfig.get_path('purelib')}\n")
    return python


def install(python: Path, *arguments: str | Path) -> None:
    """Install into another environment with this environment's pip."""
    command = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", *arguments]
    run(*command, cwd=python.parents[1])
