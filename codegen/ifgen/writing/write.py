"""Brings generated packages up to date, and says how they differ; never touches a file that is not ours.

The only place that decides what to write: `reading/manifest.py` says which files are ours, `transaction.py`
changes all of them or none.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from importlib.util import cache_from_source
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from ifgen.diagnostics import Diagnostic, InputError, shown_path
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.storage import MAX_GENERATED, read_limited
from ifgen.writing import transaction

ROOT = "."
"""The package that stands for the output folder itself."""

EDITED = ".ifgen-edited"
"""The folder in the output folder for edited files that were generated again; git ignores it."""

Kept = TypeVar("Kept")
"""The form in which a plan keeps a new content: the bytes, or the path of a file that has them."""


@dataclass(frozen=True, slots=True)
class OutputPackage:
    """A rendered package: its files by path inside its folder (with `/`), and what its manifest records.

    `beside` are files that come and go with it, by path in the output folder. `once` are the user's: they are
    written where there is nothing, and left alone from then on. One without files is a package to remove.
    """

    name: str
    files: Mapping[str, str | bytes]
    interfaces: tuple[str, ...] = ()
    source: str | None = None
    beside: Mapping[str, str] = field(default_factory=dict[str, str])
    once: Mapping[str, str] = field(default_factory=dict[str, str])
    manifest: str = manifest.NAME


class TargetFolder(NamedTuple):
    """All files that targets write into a folder, by path in it."""

    directory: Path
    files: Mapping[str, str | bytes]

    @property
    def package(self) -> OutputPackage:
        """The files as those of a package, whose folder is this one."""
        return OutputPackage(ROOT, self.files, manifest=manifest.TARGETS)


@dataclass(frozen=True, slots=True)
class Written:
    """The effects of a run on files.

    `kept` are edited files that nothing generates any more, `edited` those that were written all the same.
    """

    written: tuple[Path, ...] = ()
    unchanged: tuple[Path, ...] = ()
    removed: tuple[Path, ...] = ()
    kept: tuple[Path, ...] = ()
    edited: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class Drift:
    """A file that is not as generating would leave it: `found` is None where it is missing.

    `expected` is None where it is stale.
    """

    path: Path
    found: str | None
    expected: str | None

    @property
    def only_line_ends(self) -> bool:
        """Whether nothing but line ends differs, as after a checkout by a git that changes them."""
        return self.found is not None and self.found.replace("\r\n", "\n") == self.expected


@dataclass(frozen=True, slots=True)
class _Plan(Generic[Kept]):
    """The changes to make in one package folder, planned before any is made."""

    folder: Path
    old: Manifest
    new: Manifest
    changed: Mapping[Path, Kept]
    unchanged: tuple[Path, ...]
    stale: tuple[Path, ...]
    kept: tuple[Path, ...]
    edited: Mapping[Path, bytes]
    manifest: str


def write(packages: Iterable[OutputPackage], directory: Path, generator: str) -> Written:
    """Bring the packages below `directory`, an existing folder, up to date; `generator` signs the manifests.

    Edited files that are generated again are kept in the folder `EDITED`. Raises InputError if a file in
    the way is not ours or lies outside `directory`, and OSError (disk full, no permission). In either case
    every file stays as it was.
    """
    with prepared(packages, directory, generator) as finish:
        return finish()


@contextmanager
def prepared(
    packages: Iterable[OutputPackage], directory: Path, generator: str, targets: Sequence[TargetFolder] = ()
) -> Generator[Callable[[], Written]]:
    """The last step of `write`, which changes the files; until then their new contents are beside them.

    The files of `targets` change with them, all or none. One package at a time is in memory, so `packages`
    may be rendered meanwhile. Raises as `write` does.
    """
    with ExitStack() as stages:
        folders: list[_Folder] = []
        for folder, contents in ((directory, packages), *((t.directory, [t.package]) for t in targets)):
            stage = stages.enter_context(transaction.staging(folder))
            folders.append(_Folder(folder, stage, _plan_all(contents, folder, generator, stage.put)))
        if targets:
            _refuse_same_paths((folder.directory, folder.plans) for folder in folders)
        yield lambda: _apply(folders)


class _Folder(NamedTuple):
    """The changes to come in a folder, and the stage with the new contents."""

    directory: Path
    stage: transaction.Stage
    plans: list[_Plan[Path]]

    def changes(self) -> list[tuple[Path, Path | None]]:
        """The changes in order."""
        edited = {path: data for plan in self.plans for path, data in plan.edited.items()}
        aside = ((path, self.stage.put(data)) for path, data in _set_aside(edited, self.directory))
        return [*aside, *(change for plan in self.plans for change in _changes(plan, self.stage))]


def _apply(folders: Sequence[_Folder]) -> Written:
    changes = [(folder.stage, folder.changes()) for folder in folders]
    transaction.apply_all((stage, made) for stage, made in changes if made)
    plans = [plan for folder in folders for plan in folder.plans]
    edited = [path for plan in plans for path in plan.edited]
    for plan in plans:
        _tidy(plan)
    return Written(
        written=tuple(sorted(path for plan in plans for path in plan.changed)),
        unchanged=tuple(sorted(path for plan in plans for path in plan.unchanged)),
        removed=tuple(sorted(path for plan in plans for path in plan.stale)),
        kept=tuple(sorted(path for plan in plans for path in plan.kept)),
        edited=tuple(sorted(edited)),
    )


def drift(
    packages: Iterable[OutputPackage], directory: Path, targets: Sequence[TargetFolder] = ()
) -> tuple[Drift, ...]:
    """The differences between `directory` and `targets` and the result of `write`.

    Writes nothing, and raises as `write` does.
    """
    drifts: list[Drift] = []
    folders: list[tuple[Path, list[_Plan[bytes]]]] = []
    for folder, contents in ((directory, packages), *((t.directory, [t.package]) for t in targets)):
        plans = _plan_all(contents, folder, "", lambda data: data)
        folders.append((folder, plans))
        for plan in plans:
            changed = plan.changed.items()
            drifts.extend(Drift(path, _text(path), data.decode(errors="replace")) for path, data in changed)
            drifts.extend(Drift(path, _text(path), None) for path in (*plan.stale, *plan.kept))
        if folder.is_dir():
            left_over = transaction.left_over(folder, alone=transaction.is_free(folder))
            drifts.extend(Drift(path, "", None) for path in left_over)
    if targets:
        _refuse_same_paths(folders)
    return tuple(sorted(drifts, key=lambda d: d.path))


def _refuse_same_paths(folders: Iterable[tuple[Path, Sequence[_Plan[Any]]]]) -> None:
    """Raise InputError for a file that two folders have."""
    known: dict[str, int] = {}
    problems: list[Diagnostic] = []
    for number, (directory, plans) in enumerate(folders):
        for path in (path for plan in plans for path in files_of(plan.folder, directory, plan.new)):
            if known.setdefault(str(path.absolute()).casefold(), number) != number:
                message = f"{shown_path(path)} would be written twice, by a target and by another or by ifgen"
                advice = "choose another `out` for one of them"
                problems.append(Diagnostic("same-path", message, help=advice))
    if problems:
        raise InputError(problems)


def set_aside(path: Path, directory: Path) -> Path:
    """The place for the edited version of a file in the output folder that is generated again."""
    return directory / EDITED / path.relative_to(directory)


def left_behind(package: OutputPackage, directory: Path) -> list[Path]:
    """Files that became the user's in an earlier run, and that a package has no use for any more."""
    folder = directory / package.name
    names = (name for name in _old_manifest(folder).yours if name not in package.once)
    return [path for name in names if (path := folder / name).is_file()]


def is_intact(record: Manifest, folder: Path, directory: Path) -> bool:
    """Whether every file in the manifest of a generated package is as ifgen wrote it.

    Of those that are the user's it is enough that they exist.
    """
    with suppress(OSError, ValueError):
        if all((folder / name).is_file() for name in record.yours):
            listed = files_of(folder, directory, record)
            return all(manifest.digest(_contents(path)) == d for path, d in listed.items())
    return False


def files_of(folder: Path, directory: Path, record: Manifest) -> dict[Path, str]:
    """The digests of the files in a manifest, by their paths."""
    inside = {folder / name: of_content for name, of_content in record.files.items()}
    return inside | {directory / name: of_content for name, of_content in record.beside.items()}


def _plan_all(
    packages: Iterable[OutputPackage], directory: Path, generator: str, keep: Callable[[bytes], Kept]
) -> list[_Plan[Kept]]:
    plans: list[_Plan[Kept]] = []
    problems: list[Diagnostic] = []
    for package in packages:
        try:
            plans.append(_plan(package, directory, generator, keep))
        except InputError as error:
            problems.extend(error.diagnostics)
    if problems:
        raise InputError(problems)
    return plans


def _plan(
    package: OutputPackage, directory: Path, generator: str, keep: Callable[[bytes], Kept]
) -> _Plan[Kept]:
    folder = directory / package.name
    old = _old_manifest(folder, package.manifest)
    texts: dict[Path, str | bytes] = {folder / name: text for name, text in package.files.items()}
    texts |= {directory / name: text for name, text in package.beside.items()}
    once = {folder / name: text for name, text in package.once.items()}
    problems = list(_outside(folder, directory, [*texts, *once]))
    changed: dict[Path, Kept] = {}
    edited: dict[Path, bytes] = {}
    unchanged: list[Path] = []
    digests: dict[Path, str] = {}
    ours = files_of(folder, directory, old)
    for path, text in texts.items():
        data = text.encode() if isinstance(text, str) else text
        digests[path] = manifest.digest(data)
        found = _contents(path) if path.is_file() else None
        if found == data:
            unchanged.append(path)
        elif path not in ours and os.path.lexists(path):
            problems.append(_foreign(path))
        else:
            changed[path] = keep(data)
            if found is not None and not _is_generated(found, (ours[path], digests[path])):
                edited[path] = found
    if problems:
        raise InputError(problems)
    for path, text in once.items():
        if os.path.lexists(path):
            ours.pop(path, None)  # an earlier ifgen may have taken it for its own
        else:
            changed[path] = keep(text.encode())
    stale, kept = _no_longer_generated(ours, digests)
    new = Manifest(
        generator,
        package.source,
        package.interfaces,
        {name: digests[folder / name] for name in package.files},
        {name: digests[directory / name] for name in package.beside},
        tuple(sorted(package.once)),
    )
    return _Plan(folder, old, new, changed, tuple(unchanged), stale, kept, edited, package.manifest)


def _old_manifest(folder: Path, name: str = manifest.NAME) -> Manifest:
    try:
        return manifest.read(folder, name) or Manifest()
    except ValueError as error:
        message = f"{shown_path(folder / name)} is broken: {error}"
        advice = "restore it, or delete the folder and generate it again"
        raise InputError([Diagnostic("broken-manifest", message, help=advice)]) from None


def _is_generated(data: bytes, digests: tuple[str, ...]) -> bool:
    """True if ifgen wrote a file, even if git has changed its line ends."""
    return any(manifest.digest(each) in digests for each in (data, data.replace(b"\r\n", b"\n")))


def _set_aside(edited: Mapping[Path, bytes], directory: Path) -> Iterator[tuple[Path, bytes]]:
    if edited:
        yield directory / EDITED / ".gitignore", b"*\n"
    for path, data in edited.items():
        yield set_aside(path, directory), data


def _no_longer_generated(
    old: Mapping[Path, str], new: Mapping[Path, str]
) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    """The files to remove, and those to keep because somebody edited them."""
    stale: list[Path] = []
    kept: list[Path] = []
    for path in old.keys() - new.keys():
        if path.is_file():
            as_written = manifest.digest(_contents(path)) == old[path]
            (stale if as_written else kept).append(path)
    return tuple(stale), tuple(kept)


def _outside(folder: Path, directory: Path, paths: Iterable[Path]) -> Iterator[Diagnostic]:
    """Targets that a name or a symbolic link takes out of the output folder."""
    root = directory.resolve()
    for place in sorted({path.parent for path in paths} | {folder}):
        if place.exists() and not place.is_dir():
            yield _foreign(place)
        real = place.resolve()
        if not real.is_relative_to(root) or (real == root and place != directory):
            message = f"{shown_path(place)} is {real}, outside the output folder {root}"
            advice = "remove the symbolic link, or choose another folder"
            yield Diagnostic("outside-output", message, help=advice)


def _foreign(path: Path) -> Diagnostic:
    advice = "move it away, or choose another folder"
    return Diagnostic(
        "foreign-file", f"{shown_path(path)} is in the way: ifgen did not write it", help=advice
    )


def _changes(plan: _Plan[Path], stage: transaction.Stage) -> Iterator[tuple[Path, Path | None]]:
    """In an order that survives being killed half-way: at any time a manifest knows every file of ours.

    Until the end it has the old digests, so a file that has not been reached is not mistaken for an edited
    one. The next run generates the same new files.
    """
    record = plan.folder / plan.manifest
    both = replace(
        plan.new,
        files={**plan.new.files, **plan.old.files},
        beside={**plan.new.beside, **plan.old.beside},
    )
    if plan.changed and both != plan.old:
        yield record, stage.put(both.to_text().encode())
    yield from plan.changed.items()
    for path in plan.stale:
        yield path, None
    if not plan.new.files and not plan.new.beside:
        if record.exists():
            yield record, None
    elif plan.new != (both if plan.changed else plan.old):
        yield record, stage.put(plan.new.to_text().encode())


def _tidy(plan: _Plan[Path]) -> None:
    """After files changed or went: their bytecode, then the folders that hold nothing any more.

    Python knows bytecode by the second and the size of its module, which two versions may share.
    """
    modules: dict[Path, set[str]] = {}
    for path in (*plan.changed, *plan.stale):
        modules.setdefault(path.parent.absolute(), set()).add(path.stem)
    for folder, stems in modules.items():
        # Beside them, where others may run Python, and where this environment's Python keeps it.
        for place in {folder / "__pycache__", Path(cache_from_source(folder / "_.py")).parent}:
            for bytecode in place.glob("*.pyc"):
                if bytecode.name.partition(".")[0] in stems:
                    with suppress(OSError):
                        bytecode.unlink()
    for folder in sorted({path.parent for path in plan.stale} | {plan.folder}, reverse=True):
        for empty in (folder / "__pycache__", folder):
            with suppress(OSError):
                empty.rmdir()


def _contents(path: Path) -> bytes:
    return read_limited(path, MAX_GENERATED)


def _text(path: Path) -> str | None:
    try:
        return _contents(path).decode(errors="replace")
    except FileNotFoundError:
        return None
