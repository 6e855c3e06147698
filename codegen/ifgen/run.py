"""Runs programs written for rclpy on one of the transports: `ifgen run server.py : client.py 41 1`."""

from __future__ import annotations

import contextlib
import os
import runpy
import signal
import subprocess
import sys
import traceback
from collections.abc import Generator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Literal

from ifgen.activation import ActivationError, folder_around, is_node_package, put_on_path
from ifgen.diagnostics import Diagnostic, UsageError

SEPARATOR = ":"
_INTERRUPTED = 130  # what a shell reports of a program that Ctrl-C ended
_PATIENCE = 5.0  # [s] that an interrupted program has for ending


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
            message = f"there is no file '{program[0]}'"
            raise UsageError([Diagnostic("no-program", message, help="to run a module, write `-m MODULE`")])
    return programs


def run(programs: Sequence[list[str]], transport: Literal["local", "rclpy", "auto"], generated: Path) -> int:
    """Run programs until the last one ends, and give the worst of their exit codes.

    `generated` is a folder with the user's own packages, unless a program is in another; it may be missing.
    Raises UsageError where there is no such transport.
    """
    files = (Path(program[0]) for program in programs if program[0] != "-m")
    own = next(filter(None, map(folder_around, files)), None)
    try:
        chosen = put_on_path(transport, own or generated)
    except ActivationError as error:
        raise UsageError([Diagnostic("no-transport", str(error))]) from None
    if len(programs) > 1 and chosen == "rclpy":
        return _run_in_processes(programs)
    programs = [_as_module(program) for program in programs]
    if len(programs) == 1:
        return _run_here(programs[0])
    # Ours can keep several programs apart in one process. Found by name: the toolkit does not depend on it.
    code: int = import_module("rclpy.impl.runner").run(programs)
    return code


def _as_module(program: list[str]) -> list[str]:
    """A node's file as the module that it is: run as a file, it would hide a package of the same name."""
    file = Path(program[0]).resolve()
    package = file.parent.parent
    if program[0] == "-m" or file.parent.name != package.name or not is_node_package(package):
        return program
    sys.path[:] = [str(package), *(entry for entry in sys.path if entry != str(package))]
    return ["-m", f"{package.name}.{file.stem}", *program[1:]]


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


def _run_here(program: list[str]) -> int:
    """Run a program in this process as Python itself would."""
    try:
        if program[0] == "-m":
            sys.argv[:] = program[1:]
            sys.path.insert(0, "")
            runpy.run_module(program[1], run_name="__main__", alter_sys=True)
        else:
            sys.argv[:] = program
            sys.path.insert(0, str(Path(program[0]).resolve().parent))
            runpy.run_path(program[0], run_name="__main__")
    except SystemExit as ending:
        if ending.code is None or isinstance(ending.code, int):
            return ending.code or 0
        print(ending.code, file=sys.stderr)
        return 1
    except BaseException as error:
        _print_error(error)
        return _INTERRUPTED if isinstance(error, KeyboardInterrupt) else 1
    return 0


def _print_error(error: BaseException) -> None:
    # The first frames are ours and runpy's, and would only be in the way.
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename in {__file__, "<frozen runpy>"}:
        trace = trace.tb_next
    traceback.print_exception(type(error), error, trace)


def _run_in_processes(programs: Sequence[list[str]]) -> int:
    """Run each program in a process: real rclpy has one default context in each."""
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "rclpy"]
    processes = [subprocess.Popen([*command, *program]) for program in programs]
    with contextlib.suppress(KeyboardInterrupt):  # the terminal has sent it to all of them
        processes[-1].wait()
    for process in processes:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
    codes: list[int] = []
    for process, program in zip(processes, programs, strict=True):
        try:
            code = process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            name = program[1] if program[0] == "-m" else program[0]
            late = f"ifgen: {name} did not end within {_PATIENCE:.0f} s after Ctrl-C; ending it"
            print(late, file=sys.stderr)
            process.kill()
            code = 1
        codes.append(_INTERRUPTED if code == -signal.SIGINT else abs(code))
    return max(codes)
