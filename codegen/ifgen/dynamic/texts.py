"""A class from the text of a definition, at run time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen.definition.described.texts import read_sources, read_texts
from ifgen.dynamic.making import make

_SEPARATOR: Final = re.compile(r"^={80}\r?\n(MSG|IDL|SRV|ACTION): (\S+)[ \t]*\r?\n", re.MULTILINE)
"""The lines between definitions that belong together, in bags and in the schemas of MCAP."""

Source: TypeAlias = tuple[str, str, str]
"""The name of a type, the encoding of its text, and the text."""

_NAME: Final = re.compile(r"(?P<of>\w+/(?P<folder>srv|action)/[A-Za-z0-9]+)_(?P<part>\w+)")
_PARTS: Final = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_IN_IMPL: Final = {
    "SendGoal": "SendGoalService",
    "GetResult": "GetResultService",
    "FeedbackMessage": "FeedbackMessage",
}


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
    `MSG: pkg/Name`, or `IDL: pkg/msg/Name`, which the type's own text may have, too. Types that have no text
    are looked for where `ifgen generate` does it, first in the folders `include`. A message that belongs to a
    service or an action, such as `pkg/srv/Name_Event`, is defined by the text of that (`SRV: pkg/srv/Name`),
    or by those of its messages.

    The same definition always returns the same class. Raises InputError with all mistakes.
    """
    sources = sources_in(type_name, text, idl=idl)
    sources += ((name, "", body) for name, body in (others or {}).items())
    if (whole := _whole_of(type_name, sources)) is not None:
        return whole.part_of(make(*read_texts(whole.type_name, whole.sources, include)))
    return make(*read_texts(type_name, sources, include))


def sources_in(type_name: str, text: str, *, idl: bool = False) -> list[tuple[str, str, str]]:
    """The (type name, encoding, text) of a type, and of those whose definitions follow in its text."""
    main, *more = _SEPARATOR.split(text)
    sources = [
        (_full(name), "idl" if kind == "IDL" else "", body)
        for kind, name, body in zip(more[::3], more[1::3], more[2::3], strict=True)
    ]
    if main.strip() or not any(name == type_name for name, _, _ in sources):
        sources.insert(0, (type_name, "idl" if idl else "", main))
    return sources


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


@dataclass(frozen=True, slots=True)
class _Whole:
    """The service or the action that a message belongs to, and what `sources` define it."""

    type_name: str
    part: str
    sources: tuple[Source, ...]

    def part_of(self, cls: Any) -> type[Any]:
        """The class of the message, of the class of the whole. Raises AttributeError if there is none."""
        found = cls
        for word in self.part.split("_"):
            found = getattr(found.Impl, _IN_IMPL[word]) if word in _IN_IMPL else getattr(found, word)
        part: type[Any] = found
        return part


def _whole_of(type_name: str, sources: Sequence[Source]) -> _Whole | None:
    """The service or action that a message belongs to, None if it belongs to none.

    Bags have either the text of the whole service, as rosbag2 writes it, or one for each of its messages. The
    parts that no text defines are empty: they do not matter for the message.
    """
    match = _NAME.fullmatch(type_name)
    if match is None:
        return None
    of, texts = match["of"], {name: text for name, _, text in sources}
    own = (of, "", texts[of] if of in texts else _joined(of, _PARTS[match["folder"]], texts))
    others = tuple(each for each in sources if each[0] != of and not each[0].startswith(f"{of}_"))
    return _Whole(of, match["part"], (own, *others))


def _joined(of: str, parts: Sequence[str], texts: Mapping[str, str]) -> str:
    return "\n---\n".join(texts.get(f"{of}_{part}", "") for part in parts) + "\n"
