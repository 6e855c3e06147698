"""The command `ifgen fmt`."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import EXISTING_OR_DASH, quiet_option
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, InputError, Source, UsageError, shown_path
from ifgen.signals import sigterm_raises

# Late imports: `ifgen --help` loads this module, and does without the parsers.


@click.command(epilog="Example: ifgen fmt interfaces --check")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING_OR_DASH)
@click.option("--check", is_flag=True, help="Write nothing; exit with 1 if a file is not in the style.")
@click.option("--diff", is_flag=True, help="Write nothing; show what would change.")
@click.option(
    "--stdin-filename",
    metavar="NAME",
    type=click.Path(path_type=Path),
    help="With - as PATH: the name of the file on standard input, as Pose.msg.",
)
@quiet_option
def fmt(paths: tuple[Path, ...], check: bool, diff: bool, stdin_filename: Path | None, quiet: bool) -> int:
    """Give interfaces and node descriptions one style.

    PATH is a .msg, .srv, .action, .idl or NoDL file, a folder with such files, or - for standard input. The
    default is the paths in [tool.ifgen] of pyproject.toml. Spaces and blank lines change; order, names,
    values and comments stay, and so does whose a comment is.
    """
    if paths == (Path("-"),):
        return _standard_input(stdin_filename)
    changed: dict[Path, tuple[str, str]] = {}
    mistakes: list[Diagnostic] = []
    number = 0
    for path in _files(paths or settle().with_paths().paths):
        number += 1
        try:
            before, after = _texts(path)
        except InputError as error:
            mistakes += error.diagnostics
            continue
        if before != after:
            changed[path] = before, after
    if diff:
        terminal.print_changes((path, *texts) for path, texts in changed.items())
    elif not check:
        _write(changed)
    terminal.print_diagnostics(mistakes, stderr=True)
    if not quiet and not diff:
        verb = "not in the style" if check else "formatted"
        for path in changed:
            print(f"{verb}: {shown_path(path)}")
        print(f"{terminal.counted(len(changed), 'file')} {verb}, of {number}")
    return 1 if mistakes or ((check or diff) and changed) else 0


def _standard_input(name: Path | None) -> int:
    """Format what comes on standard input."""
    from ifgen.formatting import formatted, has_style

    if name is None or not has_style(name):
        raise UsageError([_no_kind(name)])
    before = sys.stdin.buffer.read().decode("utf-8")
    text = formatted(Source(name, before.replace("\r\n", "\n")))
    sys.stdout.buffer.write(_with_ends_of(before, text).encode())
    return 0


def _no_kind(name: Path | None) -> Diagnostic:
    found = "standard input has no name" if name is None else f"no file called '{name}' has a style"
    return Diagnostic(
        rule="usage", message=found, help="say what it is: `--stdin-filename Pose.msg`, for example"
    )


def _files(paths: Sequence[Path]) -> Iterator[Path]:
    """The files that have a style: those that were named, and those in folders."""
    from ifgen.formatting import EXTENSIONS, has_style

    for path in paths:
        if not path.is_dir():
            if not has_style(path):
                ends = ", ".join(EXTENSIONS)
                raise UsageError(
                    [
                        Diagnostic(
                            rule="usage",
                            message=f"{shown_path(path)} has no style",
                            help=f"the names of files with one end with {ends}",
                        )
                    ]
                )
            yield path
            continue
        for folder, folders, names in os.walk(path):
            folders[:] = sorted(name for name in folders if not name.startswith((".", "__pycache__")))
            yield from (Path(folder, name) for name in sorted(names) if has_style(Path(name)))


def _texts(path: Path) -> tuple[str, str]:
    """The text of a file and the same in our style, both with its own line ends."""
    from ifgen.formatting import formatted
    from ifgen.reading import storage

    source = storage.read_source(path)
    before = storage.read_bytes(path).decode()
    return before, _with_ends_of(before, formatted(source))


def _with_ends_of(before: str, text: str) -> str:
    """The text with the line ends that most lines of a file have."""
    windows = before.count("\r\n")
    return text.replace("\n", "\r\n") if windows * 2 > before.count("\n") else text


def _write(changed: dict[Path, tuple[str, str]]) -> None:
    """Write all files, or none."""
    from ifgen.writing import transaction

    if not changed:
        return
    top = Path(os.path.commonpath([path.absolute().parent for path in changed]))
    with sigterm_raises():
        transaction.apply([(path.absolute(), after.encode()) for path, (_, after) in changed.items()], top)
