"""`ifgen init`: what a project needs to be worked on with ifgen."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import click

from ifgen import resources
from ifgen.command_kit import terminal
from ifgen.command_kit.options import EXISTING, OUTPUT_FOLDER
from ifgen.diagnostics import Diagnostic, InputError, UsageError, shown_path
from ifgen.reading.packages import find_packages
from ifgen.reading.storage import read_source
from ifgen.writing import transaction

# Late imports: PyYAML and pydantic, which the other commands do without.

_REVISION = f"v{resources.VERSION}"
_PYPROJECT = Path("pyproject.toml")
_SEVERAL = 4
"""Folders with packages that `paths` still lists; more of them are found below `.`."""


@dataclass(frozen=True, slots=True)
class _Change:
    path: Path
    before: str | None
    after: str


@click.command(epilog="Example: ifgen init interfaces -o src")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=OUTPUT_FOLDER,
    help="Where to generate (default: generated).",
)
@click.option("--github", is_flag=True, help="Add a workflow that checks everything on GitHub.")
@click.option("--pre-commit", is_flag=True, help="Add hooks that check and generate before a commit.")
@click.option("--dry-run", is_flag=True, help="Write nothing, and show the changes.")
def init(paths: tuple[Path, ...], output: Path | None, github: bool, pre_commit: bool, dry_run: bool) -> int:
    """Set up this folder as a project.

    Adds [tool.ifgen] to pyproject.toml and the output folder to .gitattributes. Existing settings stay as
    they are, so you can run it again, for another option.

    PATH is a folder with packages of interfaces or nodes. Without PATH, ifgen looks for them.
    """
    found = _settings(paths, output)
    changes = list(_changes(found, github, pre_commit))
    new = [change for change in changes if change.after != change.before]
    if dry_run:
        terminal.print_changes((change.path, change.before or "", change.after) for change in new)
    else:
        files = [(change.path.resolve(), change.after.encode()) for change in new]
        transaction.apply(files, _top_of_repository())
    for change in changes:
        if change not in new:
            print(f"{shown_path(change.path)}: nothing to add")
        elif not dry_run:
            print(f"wrote {shown_path(change.path)}")
    if new and not dry_run:
        print(f"next: {_next_step(found.paths)}")
    return 0


@dataclass(frozen=True, slots=True)
class _Settings:
    """The current or future contents of [tool.ifgen]. Paths are relative to this folder."""

    pyproject: _Change
    paths: Sequence[str]
    output: str
    tests: bool


def _settings(paths: Sequence[Path], output: Path | None) -> _Settings:
    """The current settings, else new ones. Raises UsageError if options contradict current settings."""
    from ifgen.cli import project_files
    from ifgen.config.model import read_config

    text = _text(_PYPROJECT)
    known = None if text is None else read_config(_PYPROJECT.absolute(), text.encode())
    if known is not None:
        if paths or output is not None:
            message = f"{_PYPROJECT} has [tool.ifgen] already"
            raise UsageError([Diagnostic("existing-file", message, help="change `paths` and `output` there")])
        where = [_relative(path) for path in known.paths]
        unchanged = _Change(_PYPROJECT, text, text or "")
        return _Settings(unchanged, where, _relative(known.output), known.tests)
    chosen = [_relative(path) for path in paths] or _found()
    folder = output or Path("generated")
    if folder.resolve() in {Path(path).resolve() for path in chosen}:
        message = f"{shown_path(folder)} cannot be both the source folder and the output folder"
        raise UsageError([Diagnostic("configuration", message, help="choose another folder with -o")])
    told = _relative(folder)
    changed = project_files.with_table(_PYPROJECT, text or "", {"paths": chosen, "output": told})
    return _Settings(_Change(_PYPROJECT, text, changed), chosen, told, True)


def _changes(found: _Settings, github: bool, pre_commit: bool) -> Iterator[_Change]:
    """The changes to make, pyproject.toml first. Raises UsageError if one is impossible."""
    from ifgen.cli import project_files

    yield found.pyproject
    output = PurePosixPath(found.output)
    if output.parts and output.parts[0] not in {"..", "/"}:
        path = Path(".gitattributes")
        text = _text(path)
        yield _Change(path, text, project_files.with_attributes(text or "", output))
    if github:
        yield _workflow(found.output if found.tests else "")
    if pre_commit:
        yield _hooks()


def _workflow(tests: str) -> _Change:
    """The workflow, which is the user's from then on; `tests` is the folder of those that it runs."""
    top = _top_of_repository()
    path = top / ".github" / "workflows" / "ifgen.yml"
    inputs = {"working-directory": (_relative(Path.cwd(), top), "."), "generated": (tests, "generated")}
    said = {key: value for key, (value, default) in inputs.items() if value != default}
    lines = "".join(f"          {key}: {json.dumps(value)}\n" for key, value in said.items())
    lines = lines and f"        with:\n{lines}"
    text = _text(path)
    return _Change(path, text, text or resources.skeleton("workflow.yml", revision=_REVISION) + lines)


def _hooks() -> _Change:
    from ifgen.cli import project_files

    top = _top_of_repository()
    if top != Path.cwd():
        message = f"pre-commit runs its hooks in {top}, the top of the repository, not here"
        raise UsageError([Diagnostic("configuration", message, help="run `ifgen init --pre-commit` there")])
    path = Path(".pre-commit-config.yaml")
    text = _text(path)
    return _Change(path, text, project_files.with_hooks(path, text or "", _REVISION))


def _text(path: Path) -> str | None:
    """The text of a file, line ends included; None without a file. Raises InputError, as reading does."""
    if not os.path.lexists(path):
        return None
    read_source(path)  # which says what is wrong with it
    return path.read_bytes().decode()


def _found() -> list[str]:
    """The folders here that hold packages; `interfaces`, for those to come, if there is none."""
    try:
        packages = find_packages([Path()])
    except InputError as error:
        if any(problem.rule != "no-interfaces" for problem in error.diagnostics):
            raise
        return ["interfaces"]
    roots = [PurePosixPath(_relative(package.root)) for package in packages]
    folders = sorted({root.parts[0] for root in roots if root.parts and not _is_environment(Path(root))})
    is_package_here = any(not root.parts or root.parts[0] == ".." for root in roots)
    return ["."] if is_package_here or len(folders) > _SEVERAL else folders or ["interfaces"]


def _is_environment(folder: Path) -> bool:
    """Whether a folder is in an environment of Python, where ROS's own packages may be installed."""
    return any((parent / "pyvenv.cfg").exists() for parent in (folder, *folder.parents))


def _relative(path: Path, base: Path | None = None) -> str:
    """A path from this folder on, or from another one, with `/`."""
    return Path(os.path.relpath(path, base)).as_posix()


def _top_of_repository() -> Path:
    """The folder that is a repository of git and has this one in it; else this one."""
    here = Path.cwd()
    return next((folder for folder in (here, *here.parents) if (folder / ".git").exists()), here)


def _next_step(paths: Sequence[str]) -> str:
    if any(Path(path).exists() for path in paths):
        return "`ifgen generate`"
    return "`ifgen new interface demo_msgs/msg/Name`, then `ifgen generate`"
