"""The commands that ifgen advises work: after every way of installing it, in a shell, without a network."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from .support import ROOT, environment, install, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / ".git").exists(), reason="no repository"),
]
# What would come from an index is already here, after the environment's own packages.
OFFLINE = {"PIP_NO_INDEX": "1", "PIP_NO_DEPS": "1", "PIP_NO_BUILD_ISOLATION": "0"}


def _is_installed(name: str) -> bool:
    return name.startswith("tests/conformance/") or not name.startswith(("tests/", "benchmarks/"))


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clone of the working tree, in a folder whose name must be quoted in a shell."""
    place = tmp_path_factory.mktemp("clones") / "it's a clone"
    listed = subprocess.run(
        ["git", "ls-files", "-z", "-co", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in listed.stdout.split("\0"):
        if name and (ROOT / name).is_file() and _is_installed(name):
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, place / name)
    git = ["git", "-C", str(place), "-c", "user.name=x", "-c", "user.email=x@example.com"]
    for command in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "all"]):
        subprocess.run([*git, *command], check=True, capture_output=True)
    return place


@pytest.mark.parametrize(
    ("way", "origin"),
    [
        ("editable", "editable, from /"),
        ("path", "from /"),
        ("wheel", ".whl"),
        ("repository", "it's a clone at "),
        ("folder", "from a folder of wheels"),
    ],
)
def test_advice_works(
    way: str,
    origin: str,
    clone: Path,
    wheels: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, value in OFFLINE.items():
        monkeypatch.setenv(name, value)
    toolkit, runtime = wheels
    python = environment(tmp_path / "venv")
    match way:
        case "editable":
            install(python, "--editable", clone)
        case "path":
            install(python, clone / "codegen/runtime", clone)
        case "wheel":
            install(python, runtime, toolkit)
        case "repository":
            url = f"git+{clone.as_uri()}"
            install(python, f"ifgen-ros-runtime @ {url}#subdirectory=codegen/runtime", f"ifgen-ros @ {url}")
        case "folder":
            (tmp_path / "FOLDER").symlink_to(toolkit.parent)  # what advice calls it
            monkeypatch.setenv("PIP_FIND_LINKS", str(toolkit.parent))
            # The packages of this environment come after the new one's, where pip counts them as installed.
            install(python, "--force-reinstall", "ifgen-ros", "ifgen-ros-runtime")
    pip = python.with_name("pip")
    pip.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m pip --python "{python}" "$@"\n')
    pip.chmod(0o755)
    monkeypatch.setenv("PATH", f"{python.parent}{os.pathsep}{os.environ['PATH']}")
    wanted = ["add_extra('test')", "add_runtime()"]
    if way not in {"wheel", "folder"} and shutil.which("cc"):
        wanted += ["add_native()", "add_extra('ros')"]
    for call in wanted:
        program = f"from ifgen_runtime import installation; print(installation.{call})"
        advice = run(python, "-c", program, cwd=tmp_path)
        assert advice.startswith("pip install ")
        run("sh", "-c", f"set -e; {advice}", cwd=tmp_path)
    assert run(python, "-c", "import ifgen_runtime, ifgen; ifgen.activate('local')", cwd=tmp_path) == ""
    assert origin in run(
        python, "-c", "from ifgen.config import installing; print(installing.origin())", cwd=tmp_path
    )
