"""The C extension built with AddressSanitizer and UndefinedBehaviorSanitizer, and the environment that loads it."""

from __future__ import annotations

import shutil
import subprocess
import sysconfig
from pathlib import Path

NATIVE = Path(__file__).parents[2] / "codegen" / "native"
SANITIZE = ("-std=c11", "-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
SIGNS = ("AddressSanitizer", "runtime error")
"""What the sanitizers write when they find something."""


def gcc(*arguments: str | Path) -> str:
    """What gcc prints, which must not fail."""
    ran = subprocess.run(
        ["gcc", *map(str, arguments)], capture_output=True, text=True, timeout=200, check=False
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def why_not() -> str:
    """Why it cannot be built here; empty where it can."""
    if shutil.which("gcc") is None:
        return "needs gcc"
    library = gcc("-print-file-name=libasan.so").strip()
    return "" if Path(library).is_absolute() else "needs gcc's libasan and libubsan"


def build(folder: Path) -> dict[str, str]:
    """Build it in a folder; returns what to set for a Python that imports it."""
    package = folder / "ifgen_native"
    shutil.copytree(NATIVE / "ifgen_native", package, ignore=shutil.ignore_patterns("*.so"))
    include = f"-I{sysconfig.get_path('include')}"
    sources = sorted((NATIVE / "src").glob("*.c"))
    output = package / "_native.abi3.so"
    gcc(*SANITIZE, "-fPIC", "-shared", "-fvisibility=hidden", include, *sources, "-o", output)
    libraries = [gcc(f"-print-file-name=lib{name}.so").strip() for name in ("asan", "ubsan")]
    return {
        "PYTHONPATH": str(folder),
        "LD_PRELOAD": ":".join(libraries),
        "PYTHONMALLOC": "malloc",  # or Python's own allocator hides what is freed
        "ASAN_OPTIONS": "detect_leaks=0",  # registrations are deliberately permanent; so is much of Python's memory
    }
