"""Printing: diagnostics, diffs, progress, and what a failure turns into. rich loads when it is used."""

from __future__ import annotations

import difflib
import itertools
import os
import sys
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.cli import failures, report
from ifgen.diagnostics import Diagnostic, InputError, UsageError, any_errors, shown_path
from ifgen.signals import INTERRUPTED, TERMINATED, Terminated

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

    from ifgen.generator_py.templates.exports import Comparison
    from ifgen.pipeline.values import Progress
    from ifgen.writing.write import Drift

# Late imports: rich takes longer to import than most runs take, and most print nothing with it.

_PATIENCE = 0.5
"""Seconds of work before a progress bar is worth its place."""

_DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan", "*": "yellow"}

_MAX_DIFF = 400
"""Lines of diff that somebody may still want to read."""


def exit_code_of(action: Callable[[], int]) -> int:
    """Do something, and report its failure.

    The exit code is 2 for wrong usage, 130 for Ctrl-C, 143 for SIGTERM, else 1.
    """
    try:
        code = action()
        _flush()
    except InputError as error:
        print_diagnostics(error.diagnostics, stderr=True)
        return 2 if isinstance(error, UsageError) else 1
    except BrokenPipeError:  # the reader of our output closed it
        _forget_output()
        return 1
    except OSError as error:
        _forget_output()
        print(failures.explained(error), file=sys.stderr)
        return 1
    except KeyboardInterrupt as stop:
        return _stopped(stop)
    return code


def open_closed_streams() -> None:
    """Open what the caller closed of stdin, stdout and stderr, so that no file of ours takes their place."""
    for number, (name, mode) in enumerate((("stdin", "r"), ("stdout", "w"), ("stderr", "w"))):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # gets the lowest number that is free
            setattr(sys, name, open(number, mode, encoding="utf-8", closefd=False))  # noqa: SIM115


def _flush() -> None:
    try:
        sys.stdout.flush()
    except OSError as error:
        error.filename = "standard output"
        raise


def _forget_output() -> None:
    """Drop what cannot be printed: Python would complain once more when it closes stdout."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _stopped(stop: KeyboardInterrupt) -> int:
    word, code = ("terminated", TERMINATED) if isinstance(stop, Terminated) else ("interrupted", INTERRUPTED)
    line_end = "\n" if code == INTERRUPTED and sys.stderr.isatty() else ""  # after the `^C` of the terminal
    print(f"{line_end}{word}{f': {stop}' if str(stop) else ''}", file=sys.stderr)
    return code


def print_text(text: Text) -> None:
    """Print text with styles, which are lost where stdout is no terminal."""
    _print(console(), text)


def print_diagnostics(diagnostics: Sequence[Diagnostic], *, stderr: bool = False) -> None:
    """Every diagnostic and, if there are several, how many; nothing if there is none."""
    if not diagnostics:
        return
    output = console(stderr=stderr)
    text = report.for_people(diagnostics, output.width)
    if len(diagnostics) > 1:
        text.append(f"\n{report.summary(diagnostics)}\n", "bold")
    _print(output, text)


def print_findings(diagnostics: Sequence[Diagnostic], format_: str, if_none: str) -> int:
    """Every diagnostic for people (`text`), for tools (`json`), or as annotations (`github`).

    Print `if_none` for people if there is no diagnostic. Returns the exit code: 1 if there is an error.
    """
    match format_:
        case "json":
            print(report.as_json(diagnostics))
        case "github":
            print(report.as_github_annotations(diagnostics), end="\n" if diagnostics else "")
        case _ if diagnostics:
            print_diagnostics(diagnostics)
        case _ if if_none:
            print(if_none)
        case _:
            pass
    return int(any_errors(diagnostics))


def print_comparison(comparison: Comparison) -> None:
    """Print the changes in one of ifgen's templates, and the merged result if the user's changed too."""
    base, ours = comparison.base or "", comparison.ours or ""
    names = (f"{comparison.name} (as exported)", f"{comparison.name} (ifgen's now)")
    before, after = base.splitlines(keepends=True), ours.splitlines(keepends=True)
    lines = list(difflib.unified_diff(before, after, *names))
    if comparison.yours_changed:
        yours, merged = comparison.yours or "", comparison.merged().text
        path = shown_path(comparison.path)
        before, after = yours.splitlines(keepends=True), merged.splitlines(keepends=True)
        lines += difflib.unified_diff(before, after, path, f"{path} (merged)")
    _print_diff(lines)


def print_changes(changes: Iterable[tuple[Path, str, str]]) -> None:
    """A unified diff for each file: its path, and its text before and after."""
    for path, before, after in changes:
        names = (shown_path(path) if before else os.devnull, shown_path(path))
        _print_diff(difflib.unified_diff(before.splitlines(True), after.splitlines(True), *names))


def print_drift(drifts: Iterable[Drift]) -> None:
    """A unified diff to what should be there; new and stale files, and too many, take one line each."""
    from rich.text import Text

    text = Text()
    room = _MAX_DIFF
    for drift in drifts:
        path = shown_path(drift.path)
        if drift.found is None or drift.expected is None or drift.only_line_ends or not room:
            sign, what = _in_a_word(drift)
            text.append(f"{sign * 3} {path} ({what})\n", _DIFF_STYLES[sign])
            continue
        before, after = drift.found.splitlines(keepends=True), drift.expected.splitlines(keepends=True)
        lines = difflib.unified_diff(before, after, path, f"{path} (as generated)")
        for line in itertools.islice(lines, room):
            room -= 1
            _append_diff_line(text, line)
        if not room:
            text.append("... (the rest is left out)\n", "yellow")
    _print(console(), text)


def _in_a_word(drift: Drift) -> tuple[str, str]:
    """The sign and a short word for the difference of a file."""
    if drift.found is None:
        return "+", "missing"
    if drift.expected is None:
        return "-", "stale"
    return "*", "line ends differ" if drift.only_line_ends else "differs"


def _print_diff(lines: Iterable[str]) -> None:
    from rich.text import Text

    text = Text()
    for line in lines:
        _append_diff_line(text, line)
    _print(console(), text)


def _append_diff_line(text: Text, line: str) -> None:
    style = "bold" if line.startswith(("---", "+++")) else _DIFF_STYLES.get(line[0], "")
    text.append(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n", style)


@contextmanager
def progress_bar(title: str) -> Generator[Progress | None]:
    """Give a function to report progress to, which draws a bar once work goes on for long; None in a pipe."""
    if not sys.stderr.isatty():  # asked before rich is imported, which takes longer than most runs
        yield None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[name]}"))
    bar = Progress(*columns, console=console(stderr=True), transient=True)
    task = bar.add_task(title, total=None, name="")
    started = time.monotonic()

    def advance(done: int, total: int, name: str) -> None:
        if time.monotonic() - started > _PATIENCE and not bar.live.is_started:
            bar.start()
        bar.update(task, completed=done, total=total, name=name)

    try:
        yield advance
    finally:
        bar.stop()


def console(*, stderr: bool = False) -> Console:
    """A terminal with its width and colours, or a pipe without them; NO_COLOR is respected."""
    from rich.console import Console

    return Console(stderr=stderr, highlight=False, markup=False, emoji=False)


def _print(output: Console, text: Text) -> None:
    output.print(text, end="", soft_wrap=True)


def counted(number: int, noun: str) -> str:
    """The number with its noun: `1 file`, `2 files`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
