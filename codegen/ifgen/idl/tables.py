"""Makes parsers of grammars, and keeps lark's tables in the user's cache folder."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import lark

from ifgen.writing import cache


def parse_function(grammar: str, start: str, transformer: object) -> Callable[[str], Any]:
    """The function that parses a text by a grammar of this folder; `transformer` makes the result."""
    path = (Path(__file__).parent / grammar).with_suffix(".lark")
    text = path.read_text(encoding="utf-8")
    # Placeholders are on by default in lark 1.x and off in lark-parser 0.12, whose types differ as well.
    options: dict[str, Any] = {"maybe_placeholders": False, "transformer": transformer}
    # Computing the tables takes as long as parsing a hundred interfaces. lark records their source, and
    # computes them again if that has changed or the file is damaged. lark-parser always writes them.
    name = f"{grammar}-{lark.__version__}-{sys.implementation.cache_tag}"
    try:
        tables = cache.folder() / name
        parser: Any = lark.Lark(text, parser="lalr", start=start, cache=str(tables), **options)
    except OSError:
        parser = lark.Lark(text, parser="lalr", start=start, **options)
    return cast("Callable[[str], Any]", parser.parse)
