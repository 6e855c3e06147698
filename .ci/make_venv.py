"""Makes a virtual environment with a recent pip, and says in one sentence what is missing if it cannot.

Usage: python3 .ci/make_venv.py FOLDER. A folder that is a working environment stays as it is.
"""

import subprocess
import sys
import venv
from pathlib import Path

PIP = "pip>=25.1"  # the first with --group


def main() -> None:
    """Make the environment named on the command line."""
    if sys.version_info < (3, 11):  # noqa: UP036 - whatever `python3` is, it runs this
        version = sys.version.split()[0]
        sys.exit(f"error: ifgen needs Python 3.11 or newer, this is {version}; try make PYTHON=python3.11")
    folder = Path(sys.argv[1])
    python = folder / "bin" / "python"
    if not works(python, "pip"):
        make(folder, python)
    run(str(python), "-m", "pip", "install", "--quiet", "--upgrade", PIP)


def make(folder: Path, python: Path) -> None:
    """Make the environment; where Debian has split pip off from Python, borrow the system's pip."""
    has_pip = works(sys.executable, "ensurepip")
    if not has_pip and not works(sys.executable, "pip"):
        name = f"python{sys.version_info.major}.{sys.version_info.minor}-venv"
        sys.exit(
            f"error: this Python cannot make virtual environments; on Debian or Ubuntu: apt install {name}"
        )
    venv.create(folder, clear=True, symlinks=True, with_pip=has_pip)
    if not has_pip:
        run(sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", PIP)


def works(python: Path | str, module: str) -> bool:
    """Whether an interpreter runs and has a module."""
    try:
        return (
            subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False).returncode
            == 0
        )
    except OSError:
        return False


def run(*command: str) -> None:
    """Run a command; its own output says what went wrong if it fails."""
    code = subprocess.run(command, check=False).returncode
    if code:
        sys.exit(code)


if __name__ == "__main__":
    main()
