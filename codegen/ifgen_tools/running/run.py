"""Runs programs written for rclpy on one of the transports: `ifgen run server.py : client.py 41 1`."""

from __future__ import annotations

import _thread
import contextlib
import os
import re
import sys
from collections.abc import Callable, Generator, Sequence
from functools import partial
from io import TextIOWrapper
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

from ifgen.activation import ActivationError, folder_around, is_node_package, put_on_path
from ifgen.command_kit.tool import did_you_mean
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.reading.listed_file import EXTENSIONS
from ifgen.reading.storage import near_paths

from ifgen_tools.running import elsewhere, processes
from ifgen_tools.running.ending import INTERRUPTED, exit_code, is_interruption, tell
from ifgen_tools.running.program import Program, find

SEPARATOR = ":"


def split(words: Sequence[str], generated: Path | None = None) -> list[list[str]]:
    """The programs on a command line: a file, `-m` and a module, or a package and a node; then arguments.

    Those of packages become files or modules; `generated` has the user's, by default as configured. Raises
    UsageError.
    """
    programs: list[list[str]] = [[]]
    for word in words:
        if word == SEPARATOR:
            programs.append([])
        else:
            programs[-1].append(word)
    for program in programs:
        _check_parameters(program)
    return [_without_package(program, generated or settle().output) for program in programs]


def _check_parameters(program: Sequence[str]) -> None:
    """Raise UsageError for `-p rate=2.0`, of which rcl only says that it expected another lexeme."""
    words = list(program[program.index("--ros-args") :]) if "--ros-args" in program else []
    for option, word in pairwise(words):
        if option == "--":
            return
        name, equals, value = word.partition("=")
        if option in ("-p", "--param") and ":=" not in word and equals and name:
            message = f"`{option} {word}` sets no parameter"
            raise UsageError([Diagnostic("no-program", message, help=f"write `{option} {name}:={value}`")])


def _without_package(program: list[str], generated: Path) -> list[str]:
    """A program whose package, if it has one, has become its file or module. Raises UsageError."""
    if not program or program == ["-m"]:
        advice = "such as `ifgen run server.py : client.py 41 1`, with spaces around the `:`"
        raise UsageError([Diagnostic("no-program", "there is no program to run", help=advice)])
    first, *others = program
    if first == "-m" or Path(first).is_file():
        if first.endswith(EXTENSIONS) or ".nodl." in first:
            message = f"'{first}' describes an interface or a node: it is no program"
            advice = f"`ifgen generate {first}` makes Python of it"
            raise UsageError([Diagnostic("no-program", message, help=advice)])
        return program
    if first.startswith("-"):
        ours = ("--transport", "--lockstep", "--generate", "--help")
        meant = did_you_mean(first.partition("=")[0], ours, limit=1, cutoff=0.6)
        hint = f"{meant} `ifgen run --help` lists them".lstrip()
        raise UsageError([Diagnostic("no-program", f"there is no option '{first}'", help=hint)])
    from ifgen_tools.running import packages  # late: a program that is a file or a module is found without

    package = packages.find(first, generated) if re.fullmatch(r"[\w-]+", first) else None
    if package is None:
        if Path(first).is_dir():
            programs = ", ".join(sorted(path.name for path in Path(first).glob("*.py")))
            message = f"'{first}' is a folder: name a program in it"
            advice = f"it has {programs}" if programs else "it has no Python file"
            raise UsageError([Diagnostic("no-program", message, help=advice)])
        advice = "to run a module, write `-m MODULE`; to run a node of a package, `PACKAGE NODE`"
        if others and re.fullmatch(r"[\w-]+", first):
            help = packages.missing(first, generated).help
            raise UsageError([Diagnostic("no-program", f"there is no file or package '{first}'", help=help)])
        if near := near_paths(first):
            advice = f"did you mean {' or '.join(near)}? If not: {advice}"
        raise UsageError([Diagnostic("no-program", f"there is no file '{first}'", help=advice)])
    if not others:
        message = f"'{first}' is a package: name one of its nodes, too"
        names = ", ".join(sorted(package.executables)) or "none"
        raise UsageError([Diagnostic("no-program", message, help=f"it has {names}")])
    found = packages.executable_of(package, others[0])
    if not found.is_python:
        advice = f"start it by its path: {found.words[0]}"
        raise UsageError([Diagnostic("no-program", f"'{others[0]}' is no program in Python", help=advice)])
    return [*found.words, *others[1:]]


def run(
    command_lines: Sequence[list[str]],
    transport: Literal["local", "rclpy", "auto"],
    generated: Path,
    *,
    in_lockstep: bool = False,
    tells: bool = True,
) -> int:
    """Run programs, each in a process, until the last one ends; return the worst of their exit codes.

    `generated` is a folder with the user's own packages, unless a program is in another; it may be missing.
    `in_lockstep`: with one virtual time for all. If nodes run on the other transport only, it `tells` so on
    stderr. Raises UsageError where there is no such transport, or program.
    """
    if in_lockstep:
        transport = _transport_of_lockstep(transport)
    files = [Path(words[0]) for words in command_lines if words[0] != "-m"]
    own = next(filter(None, map(folder_around, files)), None)
    try:
        chosen = put_on_path(transport, own or generated, {str(file.resolve().parent) for file in files})
    except ActivationError as error:
        raise UsageError([Diagnostic("no-transport", str(error))]) from None
    try:
        programs = [find(_as_module(words)) for words in command_lines]
    except (SyntaxError, ValueError) as error:  # of the compiler
        tell(error.with_traceback(None))
        return 1
    if in_lockstep:
        return _run_in_lockstep(programs)
    if tells:
        elsewhere.tell(chosen)
    if len(programs) == 1:
        return _run_alone(programs[0])
    named = [(program.name, words) for program, words in zip(programs, command_lines, strict=True)]
    return processes.run(named, chosen)


def is_one_of_several() -> bool:
    """Whether this process is one of those that `run` has started, which has read the options and told."""
    return processes.NOTE in os.environ


def _transport_of_lockstep(asked: str) -> Literal["local"]:
    if asked == "rclpy":
        advice = "leave out one of `--transport rclpy` and `--lockstep`"
        raise UsageError([Diagnostic("no-transport", "the real rclpy has no lockstep", help=advice)])
    return "local"


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


def _run_in_lockstep(programs: Sequence[Program]) -> int:
    """Run programs on the local transport until the last one ends; returns the exit code of what fails."""
    from rmw_local import lockstep  # late: it is found once the transport has been chosen

    calls = [partial(_execute, program) for program in programs]
    try:
        lockstep.run(*calls, names=[program.name for program in programs])
    except lockstep.LockstepError as error:
        print(f"ifgen: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0


def _execute(program: Program) -> None:
    """Run a program in the process that is there for it."""
    try:
        program.execute()
    except Exception as error:
        if is_interruption(error):
            raise
        tell(error)
        raise SystemExit(1) from error


def _run_alone(program: Program) -> int:
    """Run a program to its end; returns its exit code. What it leaves running ends with this process."""
    note = processes.take_note()
    ending: BaseException | None = None
    report = sys.unraisablehook
    sys.unraisablehook = partial(_hear_again, report)
    try:
        if note is not None:
            processes.let_signals_come()
            _write_whole_lines()
        program.execute()
    except BaseException as error:
        ending = error
    finally:
        if getattr(sys.unraisablehook, "func", None) is _hear_again:  # else the program has its own
            sys.unraisablehook = report

    def is_dismissed() -> bool:
        return note is not None and note.exists()

    _be_quiet_when(is_dismissed)
    if ending is not None and not (is_interruption(ending) and is_dismissed()):
        tell(ending)
        return exit_code(ending)
    return 0


def _hear_again(report: Callable[[Any], object], error: Any) -> None:
    """Let Ctrl-C interrupt the program where Python would drop it, as in the callback of a weak reference."""
    if isinstance(error.exc_value, KeyboardInterrupt):
        _thread.interrupt_main()
    else:
        report(error)


def _write_whole_lines() -> None:
    """Write each line at once and whole, also to a file or a pipe: other programs write there, too."""
    streams: tuple[object, ...] = (sys.stdout, sys.stderr)
    for stream in streams:
        if isinstance(stream, TextIOWrapper):  # None, where there is no output
            stream.reconfigure(line_buffering=True, write_through=False)


def _be_quiet_when(is_dismissed: Callable[[], bool]) -> None:
    """Say nothing of an interruption of ours while Python waits for the threads that the program has left."""
    report = sys.unraisablehook

    def report_others(error: Any) -> None:
        if not (is_interruption(error.exc_value) and is_dismissed()):
            report(error)

    sys.unraisablehook = report_others
