"""Running the suite, and the packages of npm that tests need."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import pytest

HERE: Final = Path(__file__).parent
ROOT: Final = HERE.parents[1]
PYTHON: Final = (sys.executable, str(HERE / "testees/python.py"))
FOXGLOVE: Final = {
    "@foxglove/cdr": "3.5.0",
    "@foxglove/rosmsg": "5.0.5",
    "@foxglove/rosmsg2-serialization": "3.1.0",
}
TYPESCRIPT: Final = {"typescript": "7.0.2"}


def run_suite(
    testee: Sequence[str], *options: str, failures: str | None = None, env: Mapping[str, str] | None = None
) -> tuple[int, str]:
    """The exit code of `ifgen conformance`, and what it printed."""
    listed = ["--failures", str(HERE / f"failures/{failures}.txt")] if failures else []
    result = subprocess.run(
        [sys.executable, "-m", "ifgen", "conformance", *listed, *options, "--", *testee],
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
        env={**os.environ, **(env or {})},
    )
    return result.returncode, result.stdout + "\n".join(result.stderr.splitlines()[-20:])


def tool(name: str) -> str:
    """The path of a program; the test is skipped without it."""
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is not installed")
    return path


def node_modules(folder: Path, packages: Mapping[str, str]) -> Path:
    """Packages of npm in a folder; the test is skipped if they cannot be had."""
    tool("node")
    names = [f"{name}@{version}" for name, version in packages.items()]
    command = [tool("npm"), "install", "--silent", "--no-audit", "--no-fund", "--prefix", str(folder), *names]
    if subprocess.run(command, capture_output=True, timeout=200, check=False).returncode:
        pytest.skip(f"npm cannot install {' '.join(names)}")
    return folder / "node_modules"


def interfaces() -> Any:
    """The model of all types of the suite."""
    from ifgen.pipeline.model import load_model

    return load_model(str(ROOT / "interfaces"), str(HERE / "interfaces"))


def write_definitions(path: Path) -> None:
    """Write the texts of all messages with those that they need, by type name, as JSON."""
    model = interfaces()
    texts = {
        interface.type_name: interface.full_definition
        for package in model.packages
        for interface in package.interfaces
        if interface.kind == "message"
    }
    path.write_text(json.dumps(texts))
