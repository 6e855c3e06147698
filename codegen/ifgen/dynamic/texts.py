"""A class at run time, from the text of a definition or a type description in any form."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeAlias, cast

from ifgen.definition.described.reading import read
from ifgen.definition.described.texts import read_sources, read_texts
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.dynamic.making import make

_LONGEST: Final = 2**24


class DescribeError(RuntimeError):
    """Nobody describes the type of a topic, for the reason in one sentence."""


@dataclass(frozen=True, slots=True)
class TypeDescription:
    """The description of a type, as a node sent it.

    `document` has the keys `type_description` and `referenced_type_descriptions`. `sources` are the
    definitions that the node knows: (type name, `msg`, `srv`, `action` or `idl`, text). `node` is the name of
    the node that answered.
    """

    type_name: str
    type_hash: str
    document: dict[str, Any] = field(repr=False)
    node: str
    sources: tuple[tuple[str, str, str], ...] = field(default=(), repr=False)


def class_of(description: object, type_hash: str | None = None) -> type[Any]:
    """The class of the type that a description is about.

    `description` is what `describe` returned, a dictionary with the keys `type_description` and
    `referenced_type_descriptions`, its JSON text, a `.json` file of rosidl as a dictionary or text, or a
    `type_description_interfaces/msg/TypeDescription`. If `type_hash` (`RIHS01_...`) is given, the description
    has to fit it.

    Constants and comments are not part of a description: the class has them only if `describe` got the
    definition, too. The same description always returns the same class. Raises InputError for a description
    that is wrong.
    """
    if not isinstance(description, TypeDescription):
        return make(*read(_document_from(description), type_hash))
    type_hash = type_hash or description.type_hash
    described, registry = read(description.document, type_hash)
    if any(text for _, _, text in description.sources):
        try:
            cls = class_from_sources(description.type_name, description.sources)
        except InputError:  # a node may have installed what it was not built with
            pass
        else:
            if cls is not None and cls.__type_hash__ == type_hash:
                return cls
    return make(described, registry)


def _document_from(description: object) -> Mapping[str, Any]:
    """The dictionary of a description that is one, or JSON text, a file of rosidl's, or a message of ROS."""
    if isinstance(description, str | bytes):
        description = _parsed(description)
    if not isinstance(description, Mapping):
        return _document_of(description)
    document = cast("Mapping[str, Any]", description)
    inner = document.get("type_description_msg")  # in a file of rosidl
    return cast("Mapping[str, Any]", inner) if isinstance(inner, Mapping) else document


def _document_of(message: Any) -> dict[str, Any]:
    """The dictionary of a `type_description_interfaces/msg/TypeDescription`. Raises InputError."""
    try:
        return {
            "type_description": _individual(message.type_description),
            "referenced_type_descriptions": [_individual(m) for m in message.referenced_type_descriptions],
        }
    except AttributeError:
        kind = type(message).__name__
        text = f"a type description is a dictionary, JSON text or a TypeDescription message, not a {kind}"
        raise InputError([Diagnostic("invalid-description", text)]) from None


def _individual(message: Any) -> dict[str, Any]:
    return {"type_name": message.type_name, "fields": [_field(field) for field in message.fields]}


def _field(message: Any) -> dict[str, Any]:
    of = message.type
    type_ = {
        "type_id": of.type_id,
        "capacity": of.capacity,
        "string_capacity": of.string_capacity,
        "nested_type_name": of.nested_type_name,
    }
    return {"name": message.name, "type": type_, "default_value": message.default_value}


def _parsed(text: str | bytes) -> object:
    try:
        if len(text) > _LONGEST:
            raise ValueError(f"it is longer than {_LONGEST} characters")
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        message = f"this is not the JSON of a type description: {error}"
        raise InputError([Diagnostic("invalid-description", message)]) from None


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
