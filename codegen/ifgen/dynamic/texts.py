"""A class from the text of a definition, at run time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from ifgen.definition.described.texts import read_sources, read_texts
from ifgen.dynamic.making import make

_SEPARATOR: Final = re.compile(r"^={80}\nMSG: (\S+)\n", re.MULTILINE)
"""The lines between definitions that belong together, in bags and in the schemas of MCAP."""


def class_from_text(
    type_name: str,
    text: str,
    *,
    others: Mapping[str, str] | None = None,
    include: Sequence[Path | str] = (),
    idl: bool = False,
) -> type[Any]:
    """The class of a type that a text defines, as `.msg`, `.srv` and `.action` files do, or `.idl` files.

    `type_name` is `pkg/msg/Name`; its middle says what the text is. `others` are the texts of other types by
    their names. They can follow the text as well, as in bags: each after a line of 80 `=` and a line
    `MSG: pkg/Name`. Types that have no text are looked for where `ifgen generate` does it, first in the
    folders `include`.

    The same definition always returns the same class. Raises InputError with all mistakes.
    """
    main, *more = _SEPARATOR.split(text) if _SEPARATOR.search(text) else [text]
    sources = [(type_name, "idl" if idl else "", main)]
    sources += ((_full(name), "", body) for name, body in zip(more[::2], more[1::2], strict=True))
    sources += ((name, "", body) for name, body in (others or {}).items())
    return make(*read_texts(type_name, sources, include))


def class_from_sources(type_name: str, sources: Iterable[tuple[str, str, str]]) -> type[Any] | None:
    """The class of a type from (type name, encoding, text) of it and of those that it needs.

    None if its own text is not among them. Raises InputError.
    """
    found = read_sources(type_name, sources)
    return None if found is None else make(*found)


def _full(name: str) -> str:
    """`pkg/msg/Name` for `pkg/Name`, as bags write it."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name
