"""The words that docs/writing.md rules out, as far as a machine can find them without false alarms."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
_EMPTY = re.compile(r"(What|Who|Whose|Whom)\b|See `?[\w.]+`?\.?$")
_TICS = re.compile(
    r"\b(so many(?! \w+ that)|anew|what there is|takes? no part|be it|no such a|is called as|passed over|to be had)\b"
)


def test_docstrings_begin_with_a_verb_or_a_noun() -> None:
    found = [f"{place}: {text}" for place, text in _docstrings() if _EMPTY.match(text)]
    assert found == []


def test_texts_use_the_usual_words() -> None:
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("changelog.d/*.md"), *_modules()]
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in pages
        if path.name != "writing.md"  # which names them
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if _TICS.search(line)
    ]
    assert found == []


def _modules() -> Iterator[Path]:
    yield from sorted((ROOT / "codegen").rglob("*.py"))


def _docstrings() -> Iterator[tuple[str, str]]:
    """The text of each docstring, those of attributes included, with its place."""
    for path in _modules():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                text = node.value.value
                if isinstance(text, str):
                    yield f"{path.relative_to(ROOT)}:{node.lineno}", text.strip()
