"""Ordinary programs print and end under `ifgen run` as they do under Python: alone, beside another, on real rclpy.

They are in `programs/`; the one beside them is `spins.py`.
"""

from __future__ import annotations

import importlib.util
import os
import re
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from ifgen import resources

from tests.real_rclpy import again_if_crashed

HERE = Path(__file__).parent
PROGRAMS = HERE / "programs"
LIMIT = 60.0  # [s] for one run
MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]

on_both = pytest.mark.parametrize(
    "transport",
    [
        "local",
        pytest.param(
            "rclpy",
            marks=[
                pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}"),
                pytest.mark.slow,
            ],
        ),
    ],
)


@dataclass(frozen=True)
class Outcome:
    stdout: str
    stderr: str
    code: int


def run(folder: Path, *command: str, interrupt: int = 0, **environment: str) -> Outcome:
    """Run a command in `programs/`; send it a signal once it is ready."""
    return again_if_crashed(
        "rclpy" if "rclpy" in command else "local",
        lambda: _run(folder, *command, interrupt=interrupt, **environment),
        lambda outcome: outcome.code,
    )


def _run(folder: Path, *command: str, interrupt: int = 0, **environment: str) -> Outcome:
    process = subprocess.Popen(
        [sys.executable, *command],
        cwd=PROGRAMS,
        env={
            **os.environ,
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONUNBUFFERED": "1",
            "ROS_LOG_DIR": str(folder),
            **environment,
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    begun = ""
    try:
        if interrupt:
            assert process.stdout is not None
            while not begun.endswith("ready\n") and (line := process.stdout.readline()):
                begun += line
            process.send_signal(interrupt)
        stdout, stderr = process.communicate(timeout=LIMIT)
    finally:
        process.kill()
    code = 128 - process.returncode if process.returncode < 0 else process.returncode
    return Outcome(begun + stdout, _own_words(stderr), code)


def _own_words(stderr: str) -> str:
    """The output without frames of tracebacks outside the program: those differ between the two rclpy."""
    stderr = re.sub(r"0x[0-9a-f]+", "ADDRESS", stderr)
    stderr = re.sub(
        r"^\[WARN\] \[\d+\.\d+\] \[rcl\]: The parameter .*\n", "", stderr, flags=re.MULTILINE
    )  # of ours
    # CPython 3.13 prints this for any weak method that it meets at exit.
    stderr = re.sub(r"Exception ignored in: <function WeakMethod(.*\n)+?AttributeError: .*\n", "", stderr)
    stderr = re.sub(r"^ +[~^]+\n", "", stderr, flags=re.MULTILINE)  # not every Python marks everything
    return re.sub(r'^  File "(?!.*/programs/).*\n(    .*\n)*', "", stderr, flags=re.MULTILINE)


def as_python(folder: Path, *words: str, interrupt: int = 0) -> Outcome:
    """The result under plain Python, on our rclpy."""
    path = os.pathsep.join(map(str, (resources.underlay(), resources.bundled_generated())))
    return run(folder, *words, interrupt=interrupt, PYTHONPATH=path)


def alone(folder: Path, *words: str, interrupt: int = 0) -> Outcome:
    return run(folder, "-m", "ifgen", "run", "--transport", "local", *words, interrupt=interrupt)


def beside(folder: Path, transport: str, *words: str, interrupt: int = 0) -> Outcome:
    command = ["-m", "ifgen", "run", "--transport", transport, "spins.py", ":", *words]
    return run(folder, *command, interrupt=interrupt, WAIT_FOR=str(folder / "spins"))


ORDINARY = [
    ["arguments.py", "0.1", "--name", "x", "--ros-args", "-r", "__node:=after", "-p", "rate:=2.5"],
    ["identity.py"],
    ["-m", "robot.node", "a", "-b"],
    ["-m", "robot", "--ros-args"],
    ["logs.py"],
    ["tasks.py"],
    ["children.py", "a"],
    *(
        ["ending.py", how]
        for how in (
            "end",
            "none",
            "number",
            "negative",
            "large",
            "text",
            "object",
            "error",
            "import",
            "interrupt",
            "hook",
            "atexit",
            "exit now",
            "exit now in a thread",
            "kill",
            "thread exits",
        )
    ),
    *(["callbacks.py", *words] for words in (["none"], ["number"], ["text"], ["error"], ["number", "many"])),
    ["signals.py", "to itself"],
]
INTERRUPTED = [
    "flag",
    "flag TERM",
    "busy",
    "leaves",
    "in spin",
    "spin",
    "spin TERM",
    "spin without handlers",
    "uncaught",
    "uncaught in spin",
    "join",
    "asyncio",
    "loop",
    "pause",
    "TERM",
]


# Representatives for a quick run: the others differ in their output rather than in their mechanism.
TYPICAL = (
    *("arguments.py", "identity.py", "-m", "error", "text", "kill"),
    *("flag TERM", "busy", "spin", "asyncio"),
)


def quick(case: Any) -> Any:
    """Mark a case that is not a representative as slow."""
    words = case if isinstance(case, list) else [case]
    return case if words[0] in TYPICAL or words[-1] in TYPICAL else pytest.param(case, marks=pytest.mark.slow)


def named(words: list[str]) -> str:
    return " ".join(words)


@pytest.mark.parametrize("words", [*map(quick, ORDINARY)], ids=named)
def test_alone(words: list[str], tmp_path: Path) -> None:
    assert alone(tmp_path, *words) == as_python(tmp_path, *words)


@on_both
@pytest.mark.parametrize("words", [*map(quick, ORDINARY)], ids=named)
def test_beside_another(words: list[str], transport: str, tmp_path: Path) -> None:
    if transport == "rclpy" and words[-1] == "many":
        pytest.skip("the real MultiThreadedExecutor never looks at the SystemExit of its threads")
    assert beside(tmp_path, transport, *words) == as_python(tmp_path, *words)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send Ctrl-C to a process")
@on_both
@pytest.mark.parametrize("how", [*map(quick, INTERRUPTED)])
def test_interrupted_beside_another(how: str, transport: str, tmp_path: Path) -> None:
    number = signal.SIGTERM if how.endswith("TERM") else signal.SIGINT
    words = ["signals.py", how]
    outcome = beside(tmp_path, transport, *words, interrupt=number)
    assert outcome == as_python(tmp_path, *words, interrupt=number)
