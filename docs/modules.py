"""Lists the modules under codegen/, with what each is for: `python docs/modules.py [ROOM]`.

ROOM is a folder there, such as ifgen/pipeline. It says so if a module has no docstring.
"""

from __future__ import annotations

import ast
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Final

CODEGEN: Final = Path(__file__).resolve().parents[1] / "codegen"
_WIDTH: Final = 118


def sentence(path: Path) -> str:
    """The first sentence of a module's docstring; empty if it has none."""
    text = ast.get_docstring(ast.parse(path.read_bytes())) or ""
    return text.partition("\n\n")[0].replace("\n", " ").partition(". ")[0].rstrip(".")


def lines(folder: Path, depth: int = 0) -> Iterator[str]:
    """A folder with its modules, then the folders in it."""
    package = folder / "__init__.py"
    yield _line(depth, f"{folder.name}/", sentence(package) if package.is_file() else "")
    for path in sorted(folder.glob("*.py")):
        if path.name != "__init__.py":
            yield _line(depth + 1, path.stem, sentence(path))
    for inner in sorted(path for path in folder.iterdir() if path.is_dir()):
        if any(inner.rglob("*.py")):
            yield from lines(inner, depth + 1)


def undocumented() -> list[str]:
    """The modules without a docstring."""
    return [str(path.relative_to(CODEGEN)) for path in sorted(CODEGEN.rglob("*.py")) if not sentence(path)]


def _line(depth: int, name: str, said: str) -> str:
    start = f"{'  ' * depth}{name:{max(30 - 2 * depth, 1)}} "
    return (
        textwrap.fill(said, _WIDTH, initial_indent=start, subsequent_indent=" " * len(start))
        or start.rstrip()
    )


def main() -> None:
    """Print the list. Exits with 1 for a folder that is not there, or a module without a docstring."""
    room = CODEGEN / (sys.argv[1] if sys.argv[1:] else "")
    if not room.is_dir():
        sys.exit(f"error: there is no folder {room}")
    print("\n".join(lines(room)))
    if missing := undocumented():
        sys.exit(f"error: these have no docstring: {', '.join(missing)}")


if __name__ == "__main__":
    main()
