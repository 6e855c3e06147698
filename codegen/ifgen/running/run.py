"""Runs programs written for rclpy on one of the transports: `ifgen run server.py : client.py 41 1`."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Generator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.running import alone, company, processes
from ifgen.running.activation import ActivationError, folder_around, is_node_package, put_on_path
from ifgen.running.ending import tell
from ifgen.running.program import find

SEPARATOR = ":"


def split(words: Sequence[str]) -> list[list[str]]:
    """The programs on a command line: a file, or `-m` and a module, then arguments. Raises UsageError."""
    programs: list[list[str]] = [[]]
    for word in words:
        if word == SEPARATOR:
            programs.append([])
        else:
            programs[-1].append(word)
    for program in programs:
        if not program or program == ["-m"]:
            advice = "such as `ifgen run server.py : client.py 41 1`, with spaces around the `:`"
            raise UsageError([Diagnostic("no-program", "there is no program to run", help=advice)])
        if program[0] != "-m" and not Path(program[0]).is_file():
            message, advice = f"there is no file '{program[0]}'", "to run a module, write `-m MODULE`"
            if program[0].startswith("-"):
                hint = _meant_option(program[0]) + "`ifgen run --help` lists them"
                message, advice = f"there is no option '{program[0]}'", hint
            raise UsageError([Diagnostic("no-program", message, help=advice)])
    return programs


def _meant_option(word: str) -> str:
    close = get_close_matches(word.partition("=")[0], ("--transport", "--generate", "--help"), n=1)
    return f"did you mean '{close[0]}'? " if close else ""


def run(
    command_lines: Sequence[list[str]], transport: Literal["local", "rclpy", "auto"], generated: Path
) -> int:
    """Run programs until the last one ends, and return the worst of their exit codes.

    `generated` is a folder with the user's own packages, unless a program is in another; it may be missing.
    Raises UsageError where there is no such transport, or no such program.
    """
    files = (Path(words[0]) for words in command_lines if words[0] != "-m")
    own = next(filter(None, map(folder_around, files)), None)
    try:
        chosen = put_on_path(transport, own or generated)
    except ActivationError as error:
        raise UsageError([Diagnostic("no-transport", str(error))]) from None
    try:
        programs = [find(_as_module(words)) for words in command_lines]
    except (SyntaxError, ValueError) as error:  # of the compiler
        tell(error.with_traceback(None))
        return 1
    if len(programs) == 1:
        return alone.run(programs[0])
    if chosen == "rclpy":
        return processes.run(programs)
    return company.run(programs)


def _as_module(words: list[str]) -> list[str]:
    """Run a node's file as the module that it is: as a file, it would hide a package of the same name."""
    file = Path(words[0]).resolve()
    package = file.parent.parent
    if words[0] == "-m" or file.parent.name != package.name or not is_node_package(package):
        return words
    sys.path[:] = [str(package), *(entry for entry in sys.path if entry != str(package))]
    return ["-m", f"{package.name}.{file.stem}", *words[1:]]


@contextlib.contextmanager
def stdout_to_stderr() -> Generator[None]:
    """Let stdout be a command's own, also where its programs run in processes of their own."""
    sys.stdout.flush()
    stdout = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(stdout, 1)
        os.close(stdout)
