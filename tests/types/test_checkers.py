"""Strict type checkers on nodes as users write them: both refuse the lines marked `refused`, and no others."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import pytest
from ifgen.pipeline.typings import write_typings

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
NODES = sorted((HERE / "nodes").glob("*.py"))
UNDERLAY = (ROOT / "codegen/underlay", ROOT / "codegen/libraries", ROOT / "codegen", ROOT / "generated")
DESCRIBED = tuple(ROOT / "generated" / name for name in ("dance_action_server", "teleop"))
# `# refused: attr-defined, reportAttributeAccessIssue`: the rule of mypy, and that of pyright.
MARK = re.compile(r"# refused: (?P<mypy>[a-z-]+), (?P<pyright>[a-zA-Z]+)$", re.MULTILINE)
MYPY_ERROR = re.compile(r"^(?P<path>.+?):(?P<line>\d+): error: .*\[(?P<rule>[a-z-]+)\]$", re.MULTILINE)

Found = dict[str, set[str]]  # rules, by the place of the statement: `topics.py:12`


def statements(path: Path) -> dict[int, int]:
    """The line at which the statement of each line begins."""
    starts = {}
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.stmt) and not hasattr(node, "body"):
            starts |= dict.fromkeys(range(node.lineno, (node.end_lineno or node.lineno) + 1), node.lineno)
    return starts


def place(path: Path, line: int) -> str:
    """Where a line belongs: to the first line of its statement."""
    return f"{path.name}:{statements(path).get(line, line)}"


def mypy(folders: tuple[Path, ...], cache: Path) -> Found:
    """Check the nodes by `mypy --strict`; the folders are where it finds packages."""
    arguments = [
        "--strict",
        "--config-file=",
        f"--cache-dir={cache}",
        "--follow-imports=silent",
        *map(str, NODES),
    ]
    ended = subprocess.run(
        [sys.executable, "-m", "mypy", *arguments],
        env={**os.environ, "MYPYPATH": os.pathsep.join(map(str, folders))},
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert ended.returncode == 1, ended.stdout + ended.stderr  # 2: it could not check
    found = defaultdict(set)
    for error in MYPY_ERROR.finditer(ended.stdout):
        found[place(Path(error["path"]), int(error["line"]))].add(error["rule"])
    return found


def pyright(folders: tuple[Path, ...], scratch: Path) -> Found:
    """Check the nodes by pyright in strict mode."""
    options = {"extraPaths": [str(folder) for folder in folders], "typeCheckingMode": "strict"}
    project = scratch / "pyrightconfig.json"
    project.write_text(json.dumps({"include": [os.path.relpath(HERE / "nodes", scratch)], **options}))
    ended = subprocess.run(
        [
            sys.executable,
            "-m",
            "pyright",
            "--outputjson",
            "--project",
            project,
            "--pythonpath",
            sys.executable,
        ],
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert ended.returncode == 1, ended.stdout + ended.stderr
    found = defaultdict(set)
    for report in json.loads(ended.stdout)["generalDiagnostics"]:
        if report["severity"] == "warning":
            continue  # that a stub's module is not installed
        line = report["range"]["start"]["line"] + 1
        found[place(Path(report["file"]), line)].add(report.get("rule", report["message"]))
    return found


def marked(rule_of: str) -> dict[str, str]:
    """The lines that are marked, each with the rule that refuses it."""
    return {
        place(path, number): mark[rule_of]
        for path in NODES
        for number, line in enumerate(path.read_text().splitlines(), start=1)
        if (mark := MARK.search(line))
    }


@pytest.fixture(scope="module")
def typings(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ...]:
    """The stubs that `ifgen typings` writes, and the runtime, which checkers find among installed packages."""
    folder = tmp_path_factory.mktemp("typings")
    write_typings(folder, folder / "generated")
    shutil.copytree(
        ROOT / "generated/humanoid_interfaces", folder / "humanoid_interfaces"
    )  # a user's messages
    return folder, ROOT / "codegen"


@pytest.mark.parametrize("checker", [pytest.param(mypy, marks=pytest.mark.slow), pyright])
@pytest.mark.parametrize("where", ["sources", pytest.param("stubs", marks=pytest.mark.slow)])
def test_what_strict_checkers_refuse(
    checker: Callable[[tuple[Path, ...], Path], Found],
    where: str,
    typings: tuple[Path, ...],
    tmp_path: Path,
) -> None:
    found = checker((*(typings if where == "stubs" else UNDERLAY), *DESCRIBED), tmp_path)
    refused = marked(checker.__name__)
    assert len(refused) > 50
    assert sorted(found) == sorted(refused)
    assert not {where: (rule, found[where]) for where, rule in refused.items() if rule not in found[where]}
