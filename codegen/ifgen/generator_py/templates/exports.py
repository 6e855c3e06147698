"""Copies of ifgen's templates in a folder of the user's, and what became of both since.

What a template was like when it was exported is kept beside it, in `.ifgen-exported/`: nothing that starts
with a dot is a template.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InputError, UsageError
from ifgen.generator_py.templates import merge
from ifgen.generator_py.templates.merge import Merged
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
        return len(list(merge.conflicts(self.yours or "")))

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
        names = ("ifgen's template now", "as it was exported", "your template")
        return merge.merge(self.base or "", self.ours or "", self.yours or "", names=names)


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
            close = get_close_matches(plain, [*known, *{k.partition("/")[0] for k in known}], n=1)
            advice = f"did you mean {close[0]}?" if close else "`ifgen templates list` names them"
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
    names = {name for name in _files(folder) if (resources.templates() / name).is_file()}
    return [_compared(name, folder) for name in sorted(names | set(_files(folder / RECORD)))]


def _compared(name: str, folder: Path) -> Comparison:
    path = folder / name
    yours = _text(path)
    extends = re.search(rf"""extends\s+["']ifgen/{re.escape(name)}["']""", yours or "") is not None
    return Comparison(
        name, path, _text(folder / RECORD / name), _text(resources.templates() / name), yours, extends
    )


def _files(folder: Path) -> list[str]:
    found = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return [path.as_posix() for path in found if not any(part.startswith(".") for part in path.parts)]


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
