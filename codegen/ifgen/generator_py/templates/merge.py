"""Merges two changed versions of a text with the one that both come from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher


@dataclass(frozen=True, slots=True)
class Merged:
    """A text with the changes of both versions; `conflicts` are marked in it as git marks them."""

    text: str
    conflicts: int


def merge(
    base: str, ours: str, yours: str, *, names: tuple[str, str, str] = ("ours", "base", "yours")
) -> Merged:
    """Merge line by line; changes of both that touch are a conflict, unless they are the same."""
    versions = tuple(text.splitlines(keepends=True) for text in (base, ours, yours))
    lines: list[str] = []
    conflicts = 0
    for old, first, second in _regions(*versions):
        if first in (old, second):
            lines += second
        elif second == old:
            lines += first
        else:
            conflicts += 1
            marked = (("<<<<<<<", names[0], first), ("|||||||", names[1], old), ("=======", "", second))
            for sign, name, part in marked:
                lines += [f"{sign} {name}".rstrip() + "\n", *map(_ended, part)]
            lines.append(f">>>>>>> {names[2]}\n")
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
    base: Sequence[str], first: Sequence[str], second: Sequence[str]
) -> Iterator[tuple[list[str], list[str], list[str]]]:
    """The texts cut into regions that begin and end at the same places of all three."""
    starts = (0, 0, 0)
    for stop in (*_common(base, first, second), (len(base), len(first), len(second))):
        yield (
            list(base[starts[0] : stop[0]]),
            list(first[starts[1] : stop[1]]),
            list(second[starts[2] : stop[2]]),
        )
        starts = stop


def _common(
    base: Sequence[str], first: Sequence[str], second: Sequence[str]
) -> Iterator[tuple[int, int, int]]:
    """The places where all three agree: before and after each common line."""
    here, there = _matches(base, first), _matches(base, second)
    for index in range(len(base)):
        if index in here and index in there:
            yield index, here[index], there[index]
            yield index + 1, here[index] + 1, there[index] + 1


def _matches(base: Sequence[str], other: Sequence[str]) -> dict[int, int]:
    blocks = SequenceMatcher(None, base, other, autojunk=False).get_matching_blocks()
    return {a + offset: b + offset for a, b, size in blocks for offset in range(size)}


def _ended(line: str) -> str:
    return line if line.endswith("\n") else line + "\n"
