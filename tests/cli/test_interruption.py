"""Ctrl-C, SIGTERM and kills: changes are complete, nothing is left behind, and one line says so."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from ifgen.pipeline import planning

from .conftest import Outcome, Run, write

IFGEN = [sys.executable, "-m", "ifgen"]
STOPPED = [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def first(original: Callable[..., object], before: Callable[[], object]) -> Callable[..., object]:
    """Wrap a function: something else happens before its first call."""
    pending = [before]

    def call(*arguments: object, **named: object) -> object:
        if pending:
            pending.pop()()
        return original(*arguments, **named)

    return call


@pytest.mark.parametrize(("number", "code", "word"), STOPPED)
def test_before_anything_is_written(
    ifgen: Run, demo_msgs: Path, monkeypatch: pytest.MonkeyPatch, number: int, code: int, word: str
) -> None:
    ifgen("generate", "demo_msgs")
    before = contents(Path("generated"))
    write(demo_msgs / "msg/Pose.msg", "float64 y\n")
    render = first(planning.render, lambda: signal.raise_signal(number))
    monkeypatch.setattr(planning, "render", render)
    assert ifgen("generate", "demo_msgs") == Outcome(code, "", f"{word}: no file was changed\n")
    assert contents(Path("generated")) == before


@pytest.mark.parametrize(("number", "code", "word"), STOPPED)
@pytest.mark.parametrize("moment", ["mkdir", "replace", "write_bytes"])
def test_while_files_are_written(
    ifgen: Run,
    demo_msgs: Path,
    monkeypatch: pytest.MonkeyPatch,
    number: int,
    code: int,
    word: str,
    moment: str,
) -> None:
    """Moving that has begun is finished, because it takes no time: there are never only some of the files."""
    ifgen("generate", "demo_msgs", "-o", "expected")
    ifgen("generate", "demo_msgs")
    write(demo_msgs / "msg/Pose.msg", "float64 y\n")
    write(demo_msgs / "action/Go.action", "---\n---\n")
    with monkeypatch.context() as patched:
        patched.setattr(Path, moment, first(getattr(Path, moment), lambda: signal.raise_signal(number)))
        done = ifgen("generate", "demo_msgs")
    if moment in {"mkdir", "write_bytes"}:  # of the output folder, and of what waits beside it
        assert done == Outcome(code, "", f"{word}: no file was changed\n")
    else:
        assert done == Outcome(code, "", f"{word}: all files had been written\n")
        assert ifgen("generate", "demo_msgs", "--check").code == 0
    assert not list(Path("generated").glob(".ifgen-tmp-*"))


def test_who_is_impatient_is_heard(ifgen: Run, demo_msgs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ifgen("generate", "demo_msgs")
    before = contents(Path("generated"))
    write(demo_msgs / "msg/Pose.msg", "float64 y\n")

    def twice() -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Path, "replace", first(Path.replace, twice))
    assert ifgen("generate", "demo_msgs") == Outcome(130, "", "interrupted: no file was changed\n")
    assert contents(Path("generated")) == before


def test_other_commands(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "scandir", first(os.scandir, lambda: signal.raise_signal(signal.SIGINT)))
    assert ifgen("hash") == Outcome(130, "", "interrupted\n")


def test_sigterm_ends_other_commands_at_once(ifgen: Run, demo_msgs: Path) -> None:
    """Programs under `ifgen run` receive the signals that they would receive alone."""
    before = signal.getsignal(signal.SIGTERM)
    ifgen("generate", "demo_msgs")
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize(("number", "code", "word"), STOPPED)
def test_while_templates_are_exported(
    ifgen: Run, monkeypatch: pytest.MonkeyPatch, number: int, code: int, word: str
) -> None:
    monkeypatch.setattr(Path, "replace", first(Path.replace, lambda: signal.raise_signal(number)))
    assert ifgen("templates", "export", "all", "own") == Outcome(code, "", f"{word}\n")
    assert contents(Path("own")) == {}


@pytest.fixture
def killed(ifgen: Run, demo_msgs: Path) -> Path:
    """The files left by a run that was killed after it had changed everything."""
    ifgen("generate", "demo_msgs")
    return write(Path("generated/.ifgen-tmp-abc123/old0"), "old\n").parent


def test_the_next_run_clears_what_a_killed_one_left(ifgen: Run, killed: Path) -> None:
    assert ifgen("generate", "demo_msgs").out == "generated: up to date (8 files)\n"
    assert not killed.exists()


def test_the_next_run_clears_it_even_if_it_fails(ifgen: Run, demo_msgs: Path, killed: Path) -> None:
    write(demo_msgs / "msg/Pose.msg", "float64\n")
    assert ifgen("generate", "demo_msgs").code == 1
    assert not killed.exists()


def test_check_tells_what_a_killed_run_left(ifgen: Run, killed: Path) -> None:
    done = ifgen("generate", "demo_msgs", "--check")
    assert (done.code, done.out) == (1, f"--- {killed} (stale)\n")
    assert killed.exists(), "it writes nothing"


def test_what_a_run_has_in_use_is_left_alone(ifgen: Run, killed: Path) -> None:
    descriptor = os.open("generated", os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        assert ifgen("generate", "demo_msgs", "--check").code == 0
    finally:
        os.close(descriptor)


def test_without_locks_only_what_is_old_is_cleared(
    ifgen: Run, killed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)  # as on Windows
    assert ifgen("generate", "demo_msgs", "--check").code == 0
    assert ifgen("generate", "demo_msgs").code == 0
    assert killed.exists(), "another run may be at work"
    os.utime(killed, (0, 0))
    assert ifgen("generate", "demo_msgs").code == 0
    assert not killed.exists()


@pytest.mark.parametrize("closed", [">&-", ">&- 2>&- <&-"])
def test_closed_streams(demo_msgs: Path, closed: str) -> None:
    """There is no traceback, and no file of ours takes the place of a closed stream."""
    command = f"{sys.executable} -m ifgen {{}} {closed}"
    for words in ("show std_msgs/msg/String", "check demo_msgs", "generate demo_msgs"):
        done = subprocess.run(
            ["bash", "-c", command.format(words)], capture_output=True, timeout=60, check=True
        )
        assert done.stderr == b""
    assert "class Pose(" in Path("generated/demo_msgs/msg/_pose.py").read_text()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("words", ["show std_msgs/msg/String", "hash"])
def test_a_full_disk_behind_stdout(words: str) -> None:
    command = f"{sys.executable} -m ifgen {words} > /dev/full"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines()[0] in {
        "error: standard output: No space left on device",
        "error: cannot read or write: No space left on device",
    }
    assert len(done.stderr.splitlines()) == 2


def test_a_working_directory_that_is_gone(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    command = f"cd {gone}; rmdir {gone}; {sys.executable} -m ifgen check"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr == (
        "error: the working directory: it no longer exists\n  = help: change to an existing folder\n"
    )


def test_an_output_folder_that_is_a_link_to_nowhere(ifgen: Run, demo_msgs: Path) -> None:
    Path("generated").symlink_to("/nowhere/else")
    done = ifgen("generate", "demo_msgs")
    assert done == Outcome(
        1,
        "",
        "error: generated: this is a link to /nowhere/else, which does not exist\n"
        "  = help: make that folder, or delete the link\n",
    )


def test_an_output_folder_that_is_a_file(ifgen: Run, demo_msgs: Path) -> None:
    Path("generated").write_text("mine")
    done = ifgen("generate", "demo_msgs")
    told = "error: generated: this is not a folder\n  = help: choose another name, or move the existing file away\n"
    assert done == Outcome(1, "", told)
    assert Path("generated").read_text() == "mine"
