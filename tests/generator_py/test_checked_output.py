"""Linters and type checkers accept generated code, and understand its types in a user's program."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import ifgen
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(__file__).with_name("user_program.py")
WRONG = {
    number for number, line in enumerate(PROGRAM.read_text().splitlines(), 1) if line.endswith("# wrong")
}

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundled packages, and the test packages with every form of field, odd name and kind of node."""
    folder = tmp_path_factory.mktemp("checked") / "generated"
    tests = ROOT / "tests"
    ifgen.generate(
        ROOT / "interfaces",
        tests / "runtime" / "class_msgs",
        tests / "against_rosidl" / "form_msgs",
        tests / "nodes" / "packages",
        output=folder,
    )
    return folder


def import_folders(generated: Path) -> list[Path]:
    """The folders that Python imports: packages of nodes have theirs inside, next to setuptools' files."""
    packages = (path for path in sorted(generated.iterdir()) if path.is_dir())
    return [path / path.name if (path / "setup.py").exists() else path for path in packages]


def search_path(generated: Path) -> list[Path]:
    """The search path for imports of generated packages: nodes import rclpy too."""
    nodes = [path.parent for path in import_folders(generated) if path.parent != generated]
    return [generated, *nodes, ROOT / "codegen", ROOT / "codegen/underlay"]


def run(*command: str | Path, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a tool of the environment that the tests run in."""
    environment = {
        **os.environ,
        "MYPYPATH": os.pathsep.join(map(str, search_path(path) if path else [])),
    }
    return subprocess.run(
        [sys.executable, "-m", *map(str, command)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )


def test_ruff(generated: Path) -> None:
    """As in this project: the settings for generated/ apply below a folder of that name."""
    settings = (ROOT / "pyproject.toml").read_text()
    (generated.parent / "pyproject.toml").write_text(
        settings[settings.index("[tool.ruff]") : settings.index("[tool.mypy]")]
    )
    for arguments in (["format", "--check"], ["check", "--no-cache"]):
        done = run("ruff", *arguments, generated)
        assert done.returncode == 0, done.stdout[-3000:]


def test_mypy(generated: Path) -> None:
    options = [
        "--strict",
        "--explicit-package-bases",
        "--config-file=",
        f"--cache-dir={generated.parent / 'mypy'}",
    ]
    done = run("mypy", *options, *import_folders(generated), path=generated)
    assert done.returncode == 0, done.stdout[-3000:]

    done = run("mypy", *options, PROGRAM, path=generated)
    complained = {int(line.split(":")[1]) for line in done.stdout.splitlines() if ": error:" in line}
    assert complained == WRONG, done.stdout


def test_pyright(generated: Path) -> None:
    project = generated.parent
    checked = {*import_folders(generated), *generated.glob("*/test")}
    settings = {
        # Relative to the project: pyright ignores files that are named by an absolute path.
        "include": [*sorted(str(path.relative_to(project)) for path in checked), PROGRAM.name],
        "extraPaths": list(map(str, search_path(generated))),
        "typeCheckingMode": "strict",
    }
    (project / "pyrightconfig.json").write_text(json.dumps(settings))
    (project / PROGRAM.name).write_text(PROGRAM.read_text())
    done = run("pyright", "--pythonpath", sys.executable, "--outputjson", "-p", project)
    found = json.loads(done.stdout)["generalDiagnostics"]
    in_generated = [item for item in found if PROGRAM.name not in item["file"]]
    assert not in_generated, in_generated[:10]
    errors = [item for item in found if item["severity"] == "error"]
    assert {item["range"]["start"]["line"] + 1 for item in errors} == WRONG, errors
