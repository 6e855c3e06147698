"""Transcripts of the ros2 command line on the scenes: facts that our own commands are compared with.

A transcript is a text of command lines, each with what it printed:

    $ topic type /chatter
    | a line of the standard output
    ! a line of the standard error
    = 0

The last line is the exit code. `$3 topic hz /chatter` is interrupted by Ctrl-C after 3 s.
"""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
PLACE = HERE / "transcripts"


@dataclass(frozen=True)
class Run:
    """A command line without the program, and what came of it."""

    words: str
    interrupted: float | None = None  # [s] after its start
    out: str = ""
    err: str = ""
    code: int = 0

    def again(
        self, program: Sequence[str], environment: Mapping[str, str], further: Sequence[str] = ()
    ) -> Run:
        """Run it with a program, and return what comes of it now."""
        process = subprocess.Popen(
            [*program, *shlex.split(self.words), *further],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=dict(environment),
            cwd=ROOT,  # transcripts name files from there
        )
        try:
            out, err = process.communicate(timeout=self.interrupted or 60)
        except subprocess.TimeoutExpired:
            if self.interrupted is None:
                process.kill()
                process.wait()
                raise
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        return Run(self.words, self.interrupted, out, err, process.returncode)

    def __str__(self) -> str:
        after = f"{self.interrupted:g}" if self.interrupted else ""
        lines = [f"${after} {self.words}"]
        lines += [f"| {line}".rstrip(" ") for line in self.out.split("\n")[:-1]]
        lines += [f"! {line}".rstrip(" ") for line in self.err.split("\n")[:-1]]
        return "\n".join([*lines, f"= {self.code}"])


def read(path: Path) -> list[Run]:
    """The runs of a transcript. A command line may stand there alone, to be recorded."""
    runs: list[Run] = []
    for line in path.read_text().splitlines():
        if asked := re.fullmatch(r"\$([\d.]*) (.*)", line):
            runs.append(Run(asked[2], float(asked[1]) if asked[1] else None))
            continue
        if not line:
            continue
        kind, text, last = line[0], line[2:], runs[-1]
        changed = {"|": ("out", last.out + text + "\n"), "!": ("err", last.err + text + "\n")}
        name, value = changed[kind] if kind in changed else ("code", int(text))
        runs[-1] = Run(**{**last.__dict__, name: value})
    return runs


def write(path: Path, runs: Sequence[Run]) -> None:
    """Write a transcript, with an empty line between the runs."""
    path.write_text("\n\n".join(map(str, runs)) + "\n")


def environment(domain: int) -> dict[str, str]:
    """That of this process, in a domain where nobody else is, at 80 columns and without colour."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")])),
        "COLUMNS": "80",
        "NO_COLOR": "1",
    }


@contextmanager
def playing(scene: str, transport: str, environment: Mapping[str, str]) -> Iterator[None]:
    """Run a scene beside the block, by `ifgen run` on a transport."""
    program = [
        sys.executable,
        "-m",
        "ifgen",
        "run",
        "--transport",
        transport,
        str(HERE / "scenes" / f"{scene}.py"),
    ]
    process = subprocess.Popen(program, stdout=subprocess.PIPE, text=True, env=dict(environment))
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n", f"the scene {scene} did not start"
        yield
    finally:
        process.terminate()
        try:
            process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
