"""A command line for tests, in a folder of its own and with a cache of its own."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Generator
from dataclasses import dataclass
from pathlib import Path

import pytest
from ifgen.cli import main


@dataclass(frozen=True)
class Outcome:
    """The output of a command, and its exit code."""

    code: int
    out: str
    err: str


Run = Callable[..., Outcome]
Git = Callable[..., None]

STATE = "float64 x\nfloat64 y\n"
"""The definition of demo_msgs/msg/State in the first commit of `git`."""


@pytest.fixture(scope="session")
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, cache_folder: Path) -> None:
    """An empty working directory, 80 columns, no colour, and nothing of the machine's ROS."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_folder))
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    monkeypatch.delenv("ROS_DISTRO", raising=False)


@pytest.fixture
def ifgen(capsys: pytest.CaptureFixture[str]) -> Generator[Run]:
    """`ifgen("check", "demo_msgs")` runs that command."""

    def run(*arguments: str | Path) -> Outcome:
        capsys.readouterr()
        code = main.main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert "Traceback" not in err
        return Outcome(code, out, err)

    yield run


@pytest.fixture
def demo_msgs(tmp_path: Path) -> Path:
    """A small package that needs std_msgs."""
    folder = tmp_path / "demo_msgs"
    write(
        folder / "msg/Pose.msg", "# A pose.\nstd_msgs/Header header\nfloat64 x 1.5 # [m]\nfloat64[3] rest\n"
    )
    write(folder / "msg/Pair.msg", "Pose first\nPose second\n")
    write(folder / "srv/Move.srv", "Pose goal\n---\nbool ok\n")
    return folder


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


@pytest.fixture
def git(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Git:
    """`git("commit", ...)` in the working folder, which is a new repository with demo_msgs/msg/State."""
    for name in [name for name in os.environ if name.startswith("GIT_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", os.devnull)
    monkeypatch.setenv("GIT_CONFIG_SYSTEM", os.devnull)
    for role in ("AUTHOR", "COMMITTER"):
        monkeypatch.setenv(f"GIT_{role}_NAME", "me")
        monkeypatch.setenv(f"GIT_{role}_EMAIL", "me@example.org")

    def run(*arguments: str, folder: Path = tmp_path) -> None:
        subprocess.run(
            ["git", "-c", "protocol.file.allow=always", *arguments],
            cwd=folder,
            check=True,
            capture_output=True,
            timeout=60,
        )

    run("init", "--quiet", "--initial-branch=main")
    write(Path("demo_msgs/msg/State.msg"), STATE)
    commit(run)
    return run


def commit(git: Git, folder: Path = Path()) -> None:
    git("add", "--all", folder=folder)
    git("commit", "--quiet", "--message=x", folder=folder)
