"""Behaviour that needs a process of its own: start-up, pipes, signals, terminals, watching."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import pytest

from .conftest import write

IFGEN = [sys.executable, "-m", "ifgen"]


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*IFGEN, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def modules_after(*arguments: str) -> set[str]:
    code = (
        "import sys; from ifgen.cli.main import main\n"
        f"try: main({list(arguments)!r})\n"
        "except SystemExit: pass\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    return set(found.stderr.split())


def test_start_up_is_light() -> None:
    heavy = {"numpy", "pydantic", "jinja2", "watchfiles", "rich", "yaml"}
    assert not modules_after("--help") & {*heavy, "lark", "platformdirs"}
    assert not modules_after("hash", "std_msgs/msg/String") & heavy
    bare = subprocess.run(
        [sys.executable, "-c", "import ifgen, sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = set(bare.stdout.split())
    assert {m for m in loaded if m.startswith("ifgen")} == {"ifgen"}
    assert "lark" not in loaded


def test_generating_before_a_program_runs(tmp_path: Path) -> None:
    """After an edit one command is enough; a mistake is reported, and the program does not run."""
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["types"]\n')
    (tmp_path / "program.py").write_text(
        "from demo_msgs.msg import Pose\nprint(list(Pose.get_fields_and_field_types()))\n"
    )
    command = ("run", "--generate", "--transport", "local", "program.py")
    for name in ("x", "y", "y"):
        write(tmp_path / "types/demo_msgs/msg/Pose.msg", f"float64 {name}\n")
        done = run(*command)
        assert (done.returncode, done.stdout) == (0, f"['{name}']\n")
        assert done.stderr.startswith("generated: ")
    write(tmp_path / "types/demo_msgs/msg/Pose.msg", "float65 x\n")
    failed = run(*command)
    assert (failed.returncode, failed.stdout) == (1, "")
    assert "`float65` is not a type" in failed.stderr


def test_a_configuration_is_checked_once(tmp_path: Path) -> None:
    (tmp_path / "pyproject.toml").write_text("[tool.ifgen]\n")
    first, second = (modules_after("run", "--transport", "local", "-m", "this") for _ in range(2))
    assert "tomllib" in first
    assert not second & {"pydantic", "tomllib"}


def test_a_reader_that_has_had_enough() -> None:
    command = f"{sys.executable} -m ifgen hash | head -n 1"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=True)
    assert found.stdout.count("\n") == 1
    assert found.stderr == ""


def test_an_ascii_terminal(demo_msgs: Path) -> None:
    write(demo_msgs / "msg/Pose.msg", "# 机器人\nwröng\n")
    found = run("check", "demo_msgs", PYTHONIOENCODING="ascii")
    assert found.returncode == 1
    assert "Traceback" not in found.stderr
    assert "wr\\xf6ng" in found.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
@pytest.mark.parametrize("no_color", [True, False])
def test_colour_on_a_terminal_only(demo_msgs: Path, no_color: bool) -> None:
    write(demo_msgs / "msg/Pose.msg", "wrong\n")
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "80"}
    environment.pop("NO_COLOR")
    assert "\x1b[" not in run("check", "demo_msgs").stdout
    if no_color:
        environment["NO_COLOR"] = "1"
    seen = _on_terminal([*IFGEN, "check", "demo_msgs"], environment)
    assert "demo_msgs/msg/Pose.msg" in seen
    assert ("\x1b[1;31m" in seen) is not no_color


def _on_terminal(command: list[str], environment: dict[str, str]) -> str:
    import pty

    leader, follower = pty.openpty()
    process = subprocess.Popen(command, stdout=follower, stderr=follower, env=environment)
    os.close(follower)
    seen = b""
    while True:
        try:
            data = os.read(leader, 65536)
        except OSError:  # the other end is closed
            break
        if not data:
            break
        seen += data
    os.close(leader)
    process.wait(60)
    return seen.decode()


@contextmanager
def watching(*arguments: str) -> Generator[subprocess.Popen[str]]:
    command = [sys.executable, "-u", "-m", "ifgen", "generate", "--watch", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def until(process: subprocess.Popen[str], text: str) -> str:
    """Read up to a line with a text in it; pytest's time limit ends the wait if it never arrives."""
    assert process.stdout is not None
    seen = ""
    for line in process.stdout:
        seen += line
        if text in line:
            return seen
    pytest.fail(f"ended without {text!r}: {seen}")


def touch(path: Path, text: str) -> None:
    """Save as editors do: a new file replaces the old one."""
    new = path.with_suffix(".new")
    new.write_text(text)
    new.replace(path)


@pytest.mark.timeout(60)
def test_watch(demo_msgs: Path) -> None:
    config = write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\noutput = "out"\n')
    with watching() as process:
        until(process, "out: 8 files written")
        until(process, "watching demo_msgs, pyproject.toml; Ctrl-C ends it")
        touch(demo_msgs / "msg/Pose.msg", "float64 y\n")
        until(process, "out: 4 files written")
        touch(demo_msgs / "msg/Pose.msg", "float64 y\nfloat64 y\n")
        until(process, "error[duplicate-field]")
        touch(demo_msgs / "msg/Pose.msg", "float64 z\n")
        until(process, "out: 4 files written")
        (demo_msgs / "srv/Move.srv").unlink()
        until(process, "removed out/demo_msgs/srv/_move.py")
        until(process, "out:")
        touch(config, '[tool.ifgen]\npaths = ["demo_msgs"]\noutput = 5\n')
        until(process, "error[configuration]")
        touch(config, '[tool.ifgen]\npaths = ["demo_msgs"]\noutput = "out2"\n')
        until(process, "out2: 6 files written")
        until(process, "watching demo_msgs, pyproject.toml; Ctrl-C ends it")
        process.send_signal(signal.SIGINT)
        assert process.stdout is not None
        rest = process.stdout.read()
        assert process.wait(20) == 0
        assert rest == "stopped watching\n"


@pytest.mark.timeout(60)
def test_watch_with_nothing_to_watch() -> None:
    assert run("generate", "--watch").returncode == 2


@pytest.mark.timeout(60)
def test_runs_at_the_same_time_end_in_a_whole(demo_msgs: Path) -> None:
    """Every run generates one file of the package; together they must leave the union of them."""
    names = [f"Kind{i}" for i in range(6)]
    for name in names:
        write(demo_msgs / f"msg/{name}.msg", f"int32 n{name.lower()}\n")
    processes = [
        subprocess.Popen([*IFGEN, "generate", f"demo_msgs/msg/{name}.msg"], stderr=subprocess.PIPE)
        for name in names
    ]
    for process in processes:
        _, err = process.communicate(timeout=60)
        assert (process.returncode, err) == (0, b"")
    folder = Path("generated/demo_msgs/msg")
    listed = (folder / "__init__.py").read_text()
    assert all(name in listed for name in names)
    assert len(list(folder.glob("_kind*.py"))) == len(names)
    assert run("generate", "demo_msgs/msg/Kind0.msg", "--check").returncode == 0
