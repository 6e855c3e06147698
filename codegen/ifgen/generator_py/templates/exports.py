"""Copies of ifgen's templates in a folder of the user's, and what became of both since.

What a template was like when it was exported is kept beside it, in `.ifgen-exported/`: nothing that starts
with a dot is a template.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InputError, UsageError, did_you_mean
from ifgen.reading.storage import read_limited
from ifgen.writing import transaction

RECORD = ".ifgen-exported"
EVERYTHING = "all"

_BUILDING = '{{% extends "ifgen/{name}" %}}\n{{#\n  Blocks to replace:\n{blocks}\n#}}\n'


@dataclass(frozen=True, slots=True)
class Comparison:
    """One of the user's templates: as it was exported, as ifgen has it now, and as it is now.

    `base` is None if it was not exported, `ours` if ifgen no longer has it, and `yours` if the user has
    deleted it. `extends` is true if it extends ours, and so gets changes there by itself.
    """

    name: str
    path: Path
    base: str | None
    ours: str | None
    yours: str | None
    extends: bool

    @property
    def ours_changed(self) -> bool:
        """Whether ifgen's template is another one now."""
        return None not in {self.base, self.yours} and self.base != self.ours

    @property
    def yours_changed(self) -> bool:
        """Whether the user's is another one than what was exported."""
        return None not in {self.base, self.yours} and self.base != self.yours and not self.extends

    @property
    def yours_lacks(self) -> bool:
        """Whether the user's template is without what changed in ifgen's."""
        return self.ours_changed and not self.extends

    @property
    def unresolved(self) -> int:
        """The number of conflicts that are marked in the user's template."""
        return len(list(conflicts(self.yours or "")))

    @property
    def verdict(self) -> str:
        """The state of the template, in words."""
        if self.yours is None:
            return "you deleted it: ifgen's own is used"
        if self.unresolved:
            return f"{_conflicts(self.unresolved)} to resolve"
        if self.base is None:
            return (
                "extends ifgen's" if self.extends else "not exported, so changes in ifgen's cannot be found"
            )
        if self.ours is None:
            return "ifgen no longer has this template"
        if not self.ours_changed:
            unchanged = "extends ifgen's" if self.extends else "as exported"
            return "changed by you" if self.yours_changed else unchanged
        if self.extends:
            return "changed in ifgen; yours extends it"
        if not self.yours_changed:
            return "changed in ifgen"
        found = self.merged().conflicts
        return f"changed in ifgen and by you: {_conflicts(found) if found else 'both can be merged'}"

    def merged(self) -> Merged:
        """The changes of both, conflicts marked."""
        return merge(self.base or "", self.ours or "", self.yours or "")


def files(folder: Path) -> dict[str, Path]:
    """The files in a folder of templates, by their paths in it with `/`."""
    found = ((path.relative_to(folder), path) for path in sorted(folder.rglob("*")) if path.is_file())
    return {
        name.as_posix(): path
        for name, path in found
        if not any(part.startswith(".") or part == "__pycache__" for part in name.parts)
    }


def _conflicts(count: int) -> str:
    return f"{count} conflict{'s' * (count > 1)}"


def choose(wanted: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """The templates that names stand for: one, all of a folder, or `all`. Raises UsageError for others."""
    known = sorted(known)
    chosen: dict[str, None] = {}
    problems: list[Diagnostic] = []
    for name in wanted:
        plain = name.removesuffix("/")
        found = [k for k in known if plain in {EVERYTHING, k} or k.startswith(f"{plain}/")]
        chosen.update(dict.fromkeys(found))
        if not found:
            names = (*known, *{k.partition("/")[0] for k in known})
            advice = did_you_mean(plain, names, form="{}") or "`ifgen templates list` names them"
            problems.append(Diagnostic("unknown-template", f"there is no template {name}", help=advice))
    if problems:
        raise UsageError(problems)
    return tuple(chosen)


def export(
    names: Iterable[str], folder: Path, blocks: dict[str, tuple[str, ...]] | None = None
) -> list[Path]:
    """Copy our templates into a folder, and keep the originals. Returns the files written.

    With `blocks` (by template) they are not copied: what is written builds on ours and replaces nothing yet.
    Raises InputError if a file that differs is there already, and OSError; then nothing has been written.
    """
    changes: list[transaction.Change] = []
    written: list[Path] = []
    problems: list[Diagnostic] = []
    for name in names:
        ours = (resources.templates() / name).read_text(encoding="utf-8")
        text = ours if blocks is None else _building_on(name, blocks[name])
        path = folder / name
        if os.path.lexists(path):
            if not path.is_file() or read_limited(path) != text.encode():
                advice = "move it away, or export into another folder"
                message = f"{path} is in the way: it differs from the export"
                problems.append(Diagnostic("foreign-file", message, help=advice))
                continue
        else:
            written.append(path)
        changes += [(path, text.encode()), (folder / RECORD / name, ours.encode())]
    if problems:
        raise InputError(problems)
    if changes:
        folder.mkdir(parents=True, exist_ok=True)
        transaction.apply(changes, folder)
    return written


def compare(folder: Path) -> list[Comparison]:
    """The templates in a folder that replace ours or were exported, by name."""
    names = files(folder).keys() & files(resources.templates()).keys()
    return [_compared(name, folder) for name in sorted(names | files(folder / RECORD).keys())]


def _compared(name: str, folder: Path) -> Comparison:
    path = folder / name
    yours = _text(path)
    extends = re.search(rf"""extends\s+["']ifgen/{re.escape(name)}["']""", yours or "") is not None
    return Comparison(
        name, path, _text(folder / RECORD / name), _text(resources.templates() / name), yours, extends
    )


def accept(comparisons: Iterable[Comparison], folder: Path) -> list[Path]:
    """Merge the changes in our templates into the user's, and mark conflicts. Returns the files written.

    From then on they count as exported from our current ones. Raises OSError.
    """
    changes: list[transaction.Change] = []
    written: list[Path] = []
    for comparison in comparisons:
        if not comparison.ours_changed or comparison.ours is None:
            continue
        if not comparison.extends:
            changes.append((comparison.path, comparison.merged().text.encode()))
            written.append(comparison.path)
        changes.append((folder / RECORD / comparison.name, comparison.ours.encode()))
    if changes:
        transaction.apply(changes, folder)
    return written


def _building_on(name: str, blocks: Iterable[str]) -> str:
    listed = "\n".join(f"    {{% block {block} %}}{{{{ super() }}}}{{% endblock %}}" for block in blocks)
    return _BUILDING.format(name=name, blocks=listed or "    none: this template has no blocks")


def _text(path: Path) -> str | None:
    try:
        return read_limited(path).decode(errors="replace")
    except FileNotFoundError:
        return None


@dataclass(frozen=True, slots=True)
class Merged:
    """A text with the changes of both versions; `conflicts` are marked in it as git marks them."""

    text: str
    conflicts: int


def merge(base: str, ours: str, yours: str) -> Merged:
    """Merge line by line; changes of both that touch are a conflict, unless they are the same."""
    lines: list[str] = []
    conflicts = 0
    for old, first, second in _regions(*(text.splitlines(keepends=True) for text in (base, ours, yours))):
        if first in (old, second):
            lines += second
        elif second == old:
            lines += first
        else:
            conflicts += 1
            lines += ["<<<<<<< ifgen's template now\n", *map(_ended, first)]
            lines += ["||||||| as it was exported\n", *map(_ended, old)]
            lines += ["=======\n", *map(_ended, second), ">>>>>>> your template\n"]
    return Merged("".join(lines), conflicts)


def conflicts(text: str) -> Iterator[int]:
    """The places of the conflicts that `merge` or git marked in a text."""
    start: int | None = None
    parted = False
    offset = 0
    for line in text.splitlines(keepends=True):
        if line.startswith("<<<<<<< "):
            start, parted = offset, False
        elif line.rstrip() == "=======":
            parted = start is not None
        elif line.startswith(">>>>>>> ") and parted and start is not None:
            yield start
            start, parted = None, False
        offset += len(line)


def _regions(
    base: list[str], first: list[str], second: list[str]
) -> Iterator[tuple[list[str], list[str], list[str]]]:
    """The texts cut into regions that begin and end at the same places of all three."""
    starts = (0, 0, 0)
    for stop in (*_common(base, first, second), (len(base), len(first), len(second))):
        old, one, other = map(slice, starts, stop)
        yield base[old], first[one], second[other]
        starts = stop


def _common(base: list[str], first: list[str], second: list[str]) -> Iterator[tuple[int, int, int]]:
    """The places where all three agree: before and after each common line."""
    here, there = _matches(base, first), _matches(base, second)
    for index in range(len(base)):
        if index in here and index in there:
            yield index, here[index], there[index]
            yield index + 1, here[index] + 1, there[index] + 1


def _matches(base: list[str], other: list[str]) -> dict[int, int]:
    blocks = SequenceMatcher(None, base, other, autojunk=False).get_matching_blocks()
    return {a + offset: b + offset for a, b, size in blocks for offset in range(size)}


def _ended(line: str) -> str:
    return line if line.endswith("\n") else line + "\n"
