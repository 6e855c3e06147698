"""Cases as text: files, and the expected outcome."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Case:
    """Files by path, and what is said about them."""

    title: str
    files: dict[str, str] = field(default_factory=dict)
    said: str = ""


def cases(path: Path) -> Iterator[Case]:
    """Read a file of cases."""
    case, target = Case(""), None
    for line in path.read_text(encoding="utf-8").split("\n")[:-1]:
        mark, _, rest = line.partition(" ")
        if mark == "====":
            if case.title:
                yield case
            case, target = Case(rest), None
        elif mark == "----" and rest:
            target = rest
            case.files[target] = ""
        elif mark == ">>>>":
            target = None
        elif target is None:
            case.said += line + "\n"
        else:
            case.files[target] += line + "\n"
    yield case
