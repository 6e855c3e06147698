"""The three distributions name each other correctly, and no text advises another project's `ifgen`."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import ifgen
import pytest
from ifgen_runtime.installation import PUBLISHED

from .support import ROOT

pytestmark = pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout")

# On the index `ifgen` is another project, and nobody owns `ifgen-native`.
STRANGERS = re.compile(
    r"\b((pip3?|pipx|uv( pip| tool)?) (install|add|run)|uvx)( [^\s`]+)* ['\"]?ifgen(?![-_/.])\b"
    r"|\bifgen\[|\bifgen-(native|runtime)\b"
)


def project(folder: str) -> dict[str, Any]:
    found: dict[str, Any] = tomllib.loads((ROOT / folder / "pyproject.toml").read_text())["project"]
    return found


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="git does not know the files")
def test_nobody_is_told_to_install_a_strangers_project() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "-co", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    files = [ROOT / name for name in listed.stdout.split("\0") if name and ROOT / name != Path(__file__)]
    found = [
        f"{file.relative_to(ROOT)}:{number}: {line}"
        for file in files
        if file.is_file() and file.suffix not in {".png", ".gif"}
        for number, line in enumerate(file.read_text(errors="replace").splitlines(), 1)
        if STRANGERS.search(line)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "line",
    ["pip install 'ifgen[ros]'", "pip install ifgen", "uvx ifgen", "pip install -U ifgen", "ifgen-native"],
)
def test_a_line_that_would(line: str) -> None:
    assert STRANGERS.search(line)


@pytest.mark.parametrize(
    "line",
    [
        "pip install ifgen-ros",
        "pip install 'ifgen-ros[ros]'",
        "ifgen_native",
        "[tool.ifgen]",
        "uv run ifgen/x",
    ],
)
def test_a_line_that_would_not(line: str) -> None:
    assert not STRANGERS.search(line)


def test_one_version() -> None:
    assert project("codegen/runtime")["version"] == ifgen.__version__
    assert project("codegen/native")["version"] == ifgen.__version__


def test_real_ros_is_the_same_for_the_toolkit_and_for_a_robot() -> None:
    toolkit = project("")["optional-dependencies"]["ros"]
    assert toolkit == project("codegen/runtime")["optional-dependencies"]["ros"]
    assert f"ifgen-ros-native=={ifgen.__version__}" in toolkit[0]


def test_pages_say_from_where_to_install_before_the_first_release() -> None:
    """A stranger could register our names on an index until then."""
    assert not PUBLISHED, "take the sentence out of the pages, and this test away"
    for page in [*(ROOT / "docs").glob("*.md"), ROOT / "README.md"]:
        text = " ".join(page.read_text(encoding="utf-8").split())
        if re.search(r"pip install [^`]*ifgen-ros(?!-runtime` alone)", text):
            assert re.search("No index has|Until the first release", text), page.name
