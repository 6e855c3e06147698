"""Prints the figures of the house: `python docs/figures.py [--small]`.

They count files of Python under codegen/, the imports between them, and the arrows between the rooms
of ifgen. `--small` lists the modules of fewer than 60 lines that one other module imports.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles
from typing import Final

import pictures

CODEGEN: Final = Path(__file__).resolve().parents[1] / "codegen"
# Folders that are on sys.path themselves.
_ROOTS: Final = ("underlay", "libraries", "native")
SMALL: Final = 60  # [lines]


@dataclass(frozen=True)
class Module:
    """A file of Python, and what it imports."""

    path: Path
    name: str
    tree: ast.Module
    lines: int

    @property
    def is_package(self) -> bool:
        """Whether this is the __init__.py of a folder."""
        return self.path.name == "__init__.py"

    def imports(self, names: frozenset[str]) -> Iterator[str]:
        """The modules among `names` that this one imports, at its top or later."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names if alias.name in names)
            elif isinstance(node, ast.ImportFrom):
                base = self._base(node)
                for alias in node.names:
                    inner = f"{base}.{alias.name}"
                    if inner in names or base in names:
                        yield inner if inner in names else base

    def _base(self, node: ast.ImportFrom) -> str:
        """The module that a `from` names, without dots at its front."""
        if not node.level:
            return node.module or ""
        parts = self.name.split(".")
        parts = parts[: len(parts) - node.level + self.is_package]
        return ".".join((*parts, *filter(None, (node.module,))))


def modules() -> list[Module]:
    """Every module under codegen/."""
    found = []
    for path in sorted(CODEGEN.rglob("*.py")):
        text = path.read_bytes()
        parts = path.relative_to(CODEGEN).with_suffix("").parts
        parts = parts[parts[0] in _ROOTS : len(parts) - (path.name == "__init__.py")]
        found.append(Module(path, ".".join(parts), ast.parse(text), text.count(b"\n")))
    return found


def importers(house: list[Module]) -> dict[str, set[str]]:
    """The modules that import each module."""
    names = frozenset(module.name for module in house)
    found: dict[str, set[str]] = {name: set() for name in names}
    for module in house:
        for name in module.imports(names):
            found[name].add(module.name)
    return found


def small_with_one_importer(house: list[Module]) -> list[Module]:
    """The modules of fewer than 60 lines that one other module imports."""
    by = importers(house)
    return [
        module
        for module in house
        if not module.is_package and module.lines < SMALL and len(by[module.name]) == 1
    ]


def late_imports(tree: ast.AST, late: bool = False) -> int:
    """The number of imports within functions."""
    count = 0
    for node in ast.iter_child_nodes(tree):
        count += late and isinstance(node, ast.Import | ast.ImportFrom)
        count += late_imports(node, late or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))
    return count


def figures() -> Iterator[tuple[str, str]]:
    """Each figure's name and value."""
    house = modules()
    by = importers(house)
    own = [module for module in house if not module.is_package]
    total = sum(module.lines for module in house)
    sizes = [module.lines for module in own]

    def share(count: int) -> str:
        return f"{count / len(own):.1%}"

    yield "lines of Python in codegen/", f"{total:,}"
    yield "files; per 1,000 lines", f"{len(house)}; {len(house) / total * 1000:.1f}"
    yield "module: median; 9 of 10 have at most", f"{median(sizes):g}; {quantiles(sizes, n=10)[-1]:.0f}"
    yield "modules with one importer", share(sum(len(by[module.name]) == 1 for module in own))
    yield f"modules under {SMALL} lines", share(sum(size < SMALL for size in sizes))
    yield "modules that are both", share(len(small_with_one_importer(house)))
    yield "late imports", str(sum(late_imports(module.tree) for module in house))
    rooms = [room for floor in pictures.floors() for room in floor]
    arrows = sum(map(len, pictures.imports(rooms).values()))
    yield "rooms of ifgen; arrows between them", f"{len(rooms)}; {arrows}"
    page = (CODEGEN.parent / "docs/architecture.md").read_text(encoding="utf-8")
    yield "docs/architecture.md", f"{len(page.split()):,} words, {page.count(chr(10))} lines"


def main() -> None:
    """Print the figures, or the list."""
    if "--small" in sys.argv[1:]:
        house = modules()
        by = importers(house)
        for module in small_with_one_importer(house):
            print(f"{module.lines:3} {module.name:60} {', '.join(by[module.name])}")
        return
    for name, value in figures():
        print(f"{name:40} {value}")


if __name__ == "__main__":
    main()
