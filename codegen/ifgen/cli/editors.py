"""`ifgen paths` and `ifgen typings`: what editors and type checkers need to find packages and their types."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final

import click

from ifgen import resources
from ifgen.cli import terminal
from ifgen.cli.arguments import OUTPUT_FOLDER
from ifgen.cli.arguments import quiet as quiet_option
from ifgen.config.settings import Settings, settle
from ifgen.diagnostics import shown_path
from ifgen.signals import sigterm_raises

# Late imports: each command loads what it needs, so that the others start fast.

TYPINGS: Final = Path("typings")
"""Where Pyright and Pylance look for stubs unless told otherwise."""


@click.command(epilog="Example: ifgen paths --format vscode")
@click.option(
    "--format",
    "format_",
    type=click.Choice(["plain", "vscode", "pyright", "mypy", "pycharm"]),
    default="plain",
    help="What to paste where: one folder a line (plain, the default), .vscode/settings.json, pyproject.toml"
    " for pyright or mypy, or what to click in PyCharm.",
)
@click.option("--typings", metavar="DIR", type=OUTPUT_FOLDER, help="Where the stubs are (default: typings).")
@click.option("--json", "as_json", is_flag=True, help="Print the folders as JSON, in absolute paths.")
def paths(format_: str, typings: Path | None, as_json: bool) -> int:
    """Print the folders that an editor or type checker needs.

    They are those of the generated packages, and of the stubs that `ifgen typings` wrote. Without stubs they
    are the folders of the rclpy and the messages that come with ifgen, which mypy does not accept.
    """
    settings = settle()
    folders = _folders(settings, typings)
    if as_json:
        print(json.dumps({"paths": [str(folder) for folder in folders]}, indent=2))
        return 0
    root = settings.file.parent if settings.file is not None else Path.cwd()
    if format_ == "mypy" and any(_is_installed(folder) for folder in folders):
        folders = [folder for folder in folders if not _is_installed(folder)]
        print("warning: mypy refuses the folders where pip puts rclpy", file=sys.stderr)
        print("  = help: run `ifgen typings` first", file=sys.stderr)
    print("\n".join(_FORMATS[format_]([_relative(folder, root) for folder in folders])))
    return 0


@click.command(epilog="Example: ifgen typings")
@click.argument("directory", metavar="[DIR]", type=OUTPUT_FOLDER, default=TYPINGS)
@click.option("--check", is_flag=True, help="Write nothing; show a diff and exit with 1 on drift.")
@quiet_option
def typings(directory: Path, check: bool, quiet: bool) -> int:
    """Write stubs of rclpy and other libraries for type checkers.

    Writes to DIR (default: typings). The stubs fit the local rclpy and the real one, which has no types in
    ROS 2 Jazzy. Beside them come stubs of the messages of ROS, except packages that this project generates.
    """
    from ifgen.pipeline import typings as stubs

    output, found = settle().output, "up to date"
    if check:
        drifts = stubs.typings_drift(directory, output)
        terminal.print_drift(drifts)
        if drifts:
            advice = "ifgen typings" if directory == TYPINGS else f"ifgen typings {shown_path(directory)}"
            print(f"{shown_path(directory)} is not up to date: run `{advice}`", file=sys.stderr)
            return 1
    else:
        with sigterm_raises():
            done = stubs.write_typings(directory, output)
        if done.written or done.removed:
            found = f"{terminal.counted(len(done.written), 'file')} written, {len(done.removed)} removed"
    if not quiet:
        print(f"{shown_path(directory)}: {found}")
    return 0


def _folders(settings: Settings, typings: Path | None) -> list[Path]:
    """The folders, in the order in which packages are to be looked for."""
    from ifgen.pipeline.typings import are_there
    from ifgen.running.activation import import_folders

    root = settings.file.parent if settings.file is not None else Path.cwd()
    own = [Path(folder) for folder in import_folders(settings.output)]
    stubs = root / TYPINGS if typings is None else typings.absolute()
    if are_there(stubs):
        return [*own, stubs]
    bundled = (resources.underlay(), resources.bundled_generated(), resources.libraries())
    return list(dict.fromkeys([*own, *bundled]))


def _is_installed(folder: Path) -> bool:
    return "site-packages" in folder.parts


def _relative(folder: Path, root: Path) -> str:
    """A path for a file that others may have in another place: below the project as seen from there."""
    inside = folder.is_relative_to(root)
    return (folder.relative_to(root) if inside else folder).as_posix()


_NO_SOURCE: Final = "reportMissingModuleSource"
"""The rule of pyright, and of Pylance, against stubs of modules that no folder has."""


def _plain(folders: Sequence[str]) -> Iterator[str]:
    yield from folders


def _vscode(folders: Sequence[str]) -> Iterator[str]:
    severities = {_NO_SOURCE: "none"}
    settings = {
        "python.analysis.extraPaths": folders,
        "python.analysis.diagnosticSeverityOverrides": severities,
    }
    yield json.dumps(settings, indent=4)


def _pyright(folders: Sequence[str]) -> Iterator[str]:
    yield "[tool.pyright]"
    yield f"extraPaths = {json.dumps(folders)}"
    yield f"{_NO_SOURCE} = false # rclpy and the messages have stubs here, and come with `ifgen run`"


def _mypy(folders: Sequence[str]) -> Iterator[str]:
    yield "[tool.mypy]"
    yield f"mypy_path = {json.dumps([_beside_configuration(folder) for folder in folders])}"


def _beside_configuration(folder: str) -> str:
    return folder if Path(folder).is_absolute() else f"$MYPY_CONFIG_FILE_DIR/{folder}"


def _pycharm(folders: Sequence[str]) -> Iterator[str]:
    inside = [folder for folder in folders if not Path(folder).is_absolute()]
    outside = [folder for folder in folders if Path(folder).is_absolute()]
    if inside:
        yield "In the Project window, right-click each and choose Mark Directory as > Sources Root:"
        yield from (f"  {folder}" for folder in inside)
    if outside:
        yield "In Settings > Python Interpreter > Show All > Show Interpreter Paths, add each:"
        yield from (f"  {folder}" for folder in outside)


_FORMATS: Final[dict[str, Callable[[Sequence[str]], Iterator[str]]]] = {
    "plain": _plain,
    "vscode": _vscode,
    "pyright": _pyright,
    "mypy": _mypy,
    "pycharm": _pycharm,
}
