"""The parts of ifgen that other projects run before a commit and on GitHub: pre-commit hooks and the action."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import ifgen
import pytest
import yaml
from ifgen import resources
from ifgen.cli import project_files

from .support import ROOT, attempt, run

pytestmark = pytest.mark.skipif(not (ROOT / ".pre-commit-hooks.yaml").exists(), reason="no checkout")
PROGRAMS = Path(sys.executable).parent
INSTALL = "Install ifgen"
IS_GIT = pytest.mark.skipif(not (ROOT / ".git").exists(), reason="pre-commit takes a repository of git")


def loaded(name: str) -> Any:
    return yaml.safe_load((ROOT / name).read_text())


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A new project in git with one message that is not generated yet."""
    folder = tmp_path / "project"
    folder.mkdir()
    run("git", "init", "-q", cwd=folder)
    run(PROGRAMS / "ifgen", "init", "--github", "--pre-commit", cwd=folder)
    run(PROGRAMS / "ifgen", "new", "interface", "demo_msgs/msg/Name", cwd=folder)
    run("git", "add", "interfaces", "pyproject.toml", cwd=folder)
    return folder


def hook(name: str, project: Path) -> subprocess.CompletedProcess[str]:
    """Run a hook as pre-commit does: word by word, without a shell."""
    [entry] = [hook["entry"] for hook in loaded(".pre-commit-hooks.yaml") if hook["id"] == name]
    program, *words = entry.split()
    return attempt(PROGRAMS / program, *words, cwd=project)


def steps(
    project: Path, skip: str = "", **inputs: str
) -> Iterator[tuple[str, subprocess.CompletedProcess[str]]]:
    """Run the steps of the action as GitHub does, up to the first that fails; steps of other actions are skipped."""
    action = loaded("action.yml")
    assert inputs.keys() <= action["inputs"].keys()
    given = {name: str(said["default"]) for name, said in action["inputs"].items()} | inputs
    temporary = project.parent / "temporary"
    temporary.mkdir(exist_ok=True)
    path = temporary / "path"
    path.touch()
    hidden = {"PYTHONPATH", "AMENT_PREFIX_PATH"}
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    environment |= {"GITHUB_ACTION_PATH": str(ROOT), "GITHUB_PATH": str(path)}
    environment |= {"RUNNER_TEMP": str(temporary), "RUNNER_OS": "Linux"}
    environment |= {"XDG_CACHE_HOME": str(temporary / "cache")}
    for step in action["runs"]["steps"]:
        if "run" not in step or step["name"] == skip or not holds(step.get("if", "'' == ''"), given):
            continue
        said = {key: filled(value, given) for key, value in step.get("env", {}).items()}
        added = [*path.read_text().split(), str(PROGRAMS), os.environ["PATH"]]
        assert step["shell"] == "bash"
        assert "${{" not in step["run"], "what is given there would be run"
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
            cwd=project / filled(step.get("working-directory", "."), given),
            env=environment | said | {"PATH": os.pathsep.join(added)},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        yield step["name"], done
        if done.returncode:
            return


def filled(text: str, given: dict[str, str]) -> str:
    return re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: given[match[1]], text)


def holds(condition: str, given: dict[str, str]) -> bool:
    left, sign, right = re.sub(r"inputs\.([\w-]+)", lambda match: repr(given[match[1]]), condition).split(" ")
    return (left == right) == {"==": True, "!=": False}[sign]


def test_names_and_versions_agree() -> None:
    """The names and versions that `ifgen init` writes exist."""
    hooks = [hook["id"] for hook in loaded(".pre-commit-hooks.yaml")]
    left_out = {"ifgen-breaking", "ifgen-fmt"}  # one needs a choice of a revision, the other is one of taste
    assert set(hooks) - set(project_files.HOOKS) == left_out
    workflow = yaml.safe_load(resources.skeleton("workflow.yml", revision=f"v{ifgen.__version__}"))
    action = workflow["jobs"]["ifgen"]["steps"][1]["uses"]
    assert action == f"{project_files.REPOSITORY.removeprefix('https://github.com/')}@v{ifgen.__version__}"
    assert {"working-directory", "generated"} <= loaded("action.yml")["inputs"].keys()
    pages = (ROOT / "docs/ci.md").read_text()
    for name in (*loaded("action.yml")["inputs"], *hooks, f"v{ifgen.__version__}"):
        assert name in pages


def test_pre_commit_takes_what_is_written(project: Path) -> None:
    pre_commit = (sys.executable, "-m", "pre_commit")
    run(*pre_commit, "validate-manifest", ROOT / ".pre-commit-hooks.yaml", cwd=project)
    run(*pre_commit, "validate-config", cwd=project)


@pytest.mark.slow
def test_hooks(project: Path) -> None:
    assert hook("ifgen-check", project).returncode == 0
    done = hook("ifgen-generate", project)
    assert (done.returncode, done.stdout) == (1, "generated: 5 files written\n"), "of which git knows none"
    assert hook("ifgen-generate", project).returncode == 0
    message = project / "interfaces/demo_msgs/msg/Name.msg"
    message.write_text("nonsense\n")
    for name in project_files.HOOKS:
        done = hook(name, project)
        assert done.returncode == 1
        assert "Name.msg:1:" in done.stdout + done.stderr
    shutil.rmtree(project / "interfaces/demo_msgs")
    run(PROGRAMS / "ifgen", "new", "interface", "other_msgs/msg/Name", cwd=project)
    assert "removed generated/demo_msgs" in hook("ifgen-generate", project).stdout


@pytest.mark.slow
def test_the_action(project: Path) -> None:
    """All of its steps except the first two, which prepare the machine."""

    def outcome(**inputs: str) -> tuple[list[str], subprocess.CompletedProcess[str]]:
        done = list(steps(project, skip=INSTALL, **inputs))
        return [name for name, _ in done], done[-1][1]

    check, fmt, against, compare, generate, test = [
        step["name"] for step in loaded("action.yml")["runs"]["steps"]
    ][2:]
    names, last = outcome()
    assert (names, last.returncode) == ([check, compare], 1), "nothing is generated yet"
    assert "not up to date" in last.stderr
    names, last = outcome(committed="false")
    assert (names, last.returncode) == ([check, generate, test], 0)
    assert " passed" in last.stdout
    names, last = outcome(generated="")
    assert (names, last.returncode) == ([check, compare], 0)
    names, last = outcome(generated="", fmt="true")
    assert (names, last.returncode) == ([check, fmt, compare], 0)
    names, last = outcome(generated="", against="interfaces")
    assert (names, last.returncode) == ([check, against, compare], 0)

    message = project / "interfaces/demo_msgs/msg/Name.msg"
    message.write_text("string class\n")
    names, last = outcome(strict="true")
    assert (names, last.returncode) == ([check], 1)
    assert last.stdout.startswith("::error file=interfaces/demo_msgs/msg/Name.msg,line=1,")
    assert outcome(committed="false", generated="")[1].returncode == 0, "it is a warning"

    above = project.parent
    (above / "a b").mkdir()
    shutil.move(project, above / "a b" / "c")
    project.mkdir()
    names, last = outcome(generated="", **{"working-directory": "../a b/c"})
    assert (names, last.returncode) == ([check, compare], 0)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_the_action_installs_ifgen(project: Path) -> None:
    done = list(steps(project, committed="false"))
    assert done[0][0] == INSTALL
    assert [d.returncode for _, d in done] == [0, 0, 0, 0], done[-1]
    assert (project.parent / "temporary/path").read_text() == f"{project.parent}/temporary/ifgen/bin\n"


@IS_GIT
@pytest.mark.slow
@pytest.mark.timeout(600)
def test_pre_commit_installs_and_runs_the_hooks(project: Path, tmp_path: Path) -> None:
    """From this checkout as it is, in an environment that pre-commit makes from an index."""
    home = tmp_path / "pre-commit"
    words = (sys.executable, "-m", "pre_commit", "try-repo", ROOT, "--all-files", "--verbose")
    command = ("env", f"PRE_COMMIT_HOME={home}", *words)
    done = attempt(*command, cwd=project, limit=500)
    assert re.search(r"ifgen check\.+Passed", done.stdout), done.stdout + done.stderr
    assert re.search(r"ifgen generate\.+Failed", done.stdout)
    assert "generated: 5 files written" in done.stdout
    run("git", "add", ".", cwd=project)
    assert re.search(r"ifgen generate\.+Passed", run(*command, cwd=project, limit=500))
