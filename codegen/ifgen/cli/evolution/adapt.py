"""`ifgen adapt`: a module that converts messages of another version of a type."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.cli import completion, terminal
from ifgen.cli.arguments import OUTPUT_FOLDER
from ifgen.cli.arguments import include as include_option
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError, shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.evolution.adapting.plan import Planned

# Late imports: a request for help needs none of these.


@click.command(epilog="Example: ifgen adapt demo_msgs/msg/Pose --from HEAD~1")
@click.argument("type_", metavar="TYPE", shell_complete=completion.types)
@click.option(
    "--from",
    "reference",
    metavar="REF|HASH",
    required=True,
    help="The other version: a git revision, a folder, a lock file, REF:TYPE, a .json file, or a type hash.",
)
@click.option("--downgrade", is_flag=True, help="Also write the way back, to send to the other version.")
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=OUTPUT_FOLDER,
    help="The folder of adapters, a Python package (default: adapters).",
)
@include_option
def adapt(type_: str, reference: str, downgrade: bool, output: Path | None, include: tuple[Path, ...]) -> int:
    """Write a module that converts messages of another version.

    TYPE is a message, a service or an action as it is now, such as demo_msgs/msg/Pose. The module is yours
    from then on: ifgen fills in what is the same, and leaves open what only you can decide. Type checkers
    report each place. A test is written beside it.

    HASH is a type hash (RIHS01_...) or its first digits, as warnings about types print them. It is looked
    for in ifgen.lock, in the history of the repository, and in installed packages.
    """
    from ifgen.evolution.adapting.plan import plan
    from ifgen.generator_py.templates.render import Templates
    from ifgen.writing import transaction

    settings = settle(None, None, include).trusted()
    base = settings.file.parent if settings.file else Path.cwd()
    folder = output or settings.adapters
    planned = plan(type_, reference, settings.paths, settings.include, base, downgrade=downgrade)
    if (folder / planned.module.path).exists():
        raise UsageError([_existing(folder, planned)])
    _check_frozen(folder, planned)
    templates = Templates(settings.custom)
    artifacts = (planned.module, planned.tests, *planned.shared)
    texts = {
        folder / artifact.path: templates.render(artifact).text
        for artifact in artifacts
        if artifact is not None and not (folder / artifact.path).exists()
    }
    with sigterm_raises(), transaction.locked(folder):
        transaction.apply([(path, text.encode()) for path, text in texts.items()], folder)
    _report(texts, folder, planned)
    return 0


def _existing(folder: Path, planned: Planned) -> Diagnostic:
    path = folder / planned.module.path
    help = "change it by hand, or delete it and its test to have them written again"
    return Diagnostic("existing-file", f"{shown_path(path)} exists, and is yours", help=help)


def _check_frozen(folder: Path, planned: Planned) -> None:
    """Raise UsageError if a file is where a frozen module belongs, and is another one."""
    hashes = planned.versions.old_hashes
    for artifact, interface in zip(planned.shared[1:], planned.versions.frozen, strict=True):
        path = folder / artifact.path
        if path.exists() and hashes.of(interface) not in path.read_text(encoding="utf-8", errors="replace"):
            message = f"{shown_path(path)} exists, and is not the frozen {interface.type_name}"
            raise UsageError([Diagnostic("existing-file", message, help="move it away")])


def _report(texts: Mapping[Path, str], folder: Path, planned: Planned) -> None:
    for path, text in texts.items():
        is_module = path == folder / planned.module.path
        print(f"wrote {shown_path(path)}{_open(text) if is_module else ''}")
    if planned.tests is None:
        print("there is no test: these messages are too large to be tried")
    elif folder / planned.tests.path not in texts:
        print(f"kept {shown_path(folder / planned.tests.path)}")
    package = folder / planned.shared[0].path
    if "import_all" not in package.read_text(encoding="utf-8", errors="replace"):
        module = planned.module.path.removesuffix(".py")
        print(f"{shown_path(package)} is yours: add `from . import {module}` to it")
    for line in _earlier(folder, planned):
        print(line)
    steps = f"`pytest {shown_path(folder)}`, then import the package where your program starts"
    print(f"next: {steps}")


def _open(text: str) -> str:
    """How many decisions a module leaves open, and in which lines."""
    lines = [
        str(n) for n, line in enumerate(text.splitlines(), 1) if re.search(r"(=undecided|^ +lost)\($", line)
    ]
    if not lines:
        return ""
    where = f"lines {', '.join(lines[:-1])} and {lines[-1]}" if len(lines) > 1 else f"line {lines[0]}"
    return f": {terminal.counted(len(lines), 'decision')} left to you, in {where}"


def _earlier(folder: Path, planned: Planned) -> Iterator[str]:
    """Advice on adapters to the version that is an old one now: how they are chained with this one."""
    from ifgen.evolution.lock.text import written_parts

    versions = planned.versions
    frozen = planned.shared[1].path.removesuffix(".py")
    name = versions.old.name
    hashes = {versions.old_hashes.of(part) for part in written_parts(versions.old)}
    for path in sorted(folder.glob("[!_]*.py")):
        text = path.read_text(encoding="utf-8", errors="replace")
        if any(f'new_hash="{type_hash}"' in text for type_hash in hashes) and f"from .{frozen} " not in text:
            yield (
                f"{shown_path(path)} converts to this version: import it there, "
                f"with `from .{frozen} import {name}`"
            )
