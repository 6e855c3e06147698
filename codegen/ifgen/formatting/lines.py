"""Lines of a file in any language: none ends with spaces, and one empty line at most stands alone."""

from __future__ import annotations

from collections.abc import Iterable


def tidy_lines(lines: Iterable[str]) -> str:
    """The lines as a text, with a line break at its end; empty if nothing but empty lines is there."""
    kept: list[str] = []
    for line in map(str.rstrip, lines):
        if line or (kept and kept[-1]):
            kept.append(line)
    if kept and not kept[-1]:
        kept.pop()
    return "".join(f"{line}\n" for line in kept)
