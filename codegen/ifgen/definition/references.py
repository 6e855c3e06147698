"""The types that fields name: which they are, and what to say of those that do not exist."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ifgen.definition.explain import did_you_mean
from ifgen.definition.interfaces import Field, Message
from ifgen.definition.types import COLLECTIONS, NamespacedType
from ifgen.diagnostics import Diagnostic, Label, Span
from ifgen.reading import storage
from ifgen.reading.interface_list import FILE
from ifgen.reading.listed_file import GENERATE
from ifgen.reading.packages import IDL, PackageFiles
from ifgen.reading.search_path import SearchPath

_MAX_PLACES = 6
_PARTS = ("_Request", "_Response", "_Goal", "_Result", "_Feedback")
_SEPARATOR = re.compile("/|::")


def references(message: Message) -> Iterator[tuple[Field, NamespacedType]]:
    """The fields of a message that hold other messages, and those messages' types."""
    for field in message.fields:
        type_ = field.type
        if isinstance(type_, COLLECTIONS):
            type_ = type_.value_type
        if isinstance(type_, NamespacedType):
            yield field, type_


def type_span(field: Field) -> Span | None:
    """The place of the type of a field; None for derived fields."""
    if field.type_span is not None or field.span is None:
        return field.type_span
    # In a .msg file: from the first column up to a space.
    source = field.span.source
    start = field.span.start - field.span.column + 1
    words = source.text[start : field.span.start].split(None, 1)
    return Span(source, start, start + len(words[0].partition("[")[0]))


def unknown_package(type_: NamespacedType, field: Field | None, search: SearchPath) -> Diagnostic:
    """Say that the package of a field's type is nowhere to be found, and where it was looked for."""
    places = search.places()
    shown = ", ".join(places[:_MAX_PLACES]) + (", ..." if len(places) > _MAX_PLACES else "")
    return Diagnostic(
        "unknown-package",
        f"there is no interface package '{type_.package}'",
        label(field),
        help=f"{package_advice(type_.package, search)}. ifgen looked in the given paths and in {shown}",
    )


def package_advice(name: str, search: SearchPath) -> str:
    """Advice about an unknown package: perhaps another is meant, perhaps a folder is missing."""
    hint = did_you_mean(name, search.package_names())
    advice = "name the folder that it is in with -I DIR"
    return f"{hint} If not, {advice}" if hint else advice


def unknown_type(
    type_: NamespacedType, field: Field | None, package: PackageFiles, search: SearchPath
) -> Diagnostic:
    """Say that a package has no such message, and what was meant perhaps."""
    return Diagnostic(
        "unknown-type",
        f"package '{type_.package}' has no message '{type_.name}'",
        label(field),
        help=_advice(type_, field, package, search),
    )


def _advice(
    type_: NamespacedType, field: Field | None, package: PackageFiles, search: SearchPath
) -> str | None:
    for name in (f"{type_.name}.msg", f"{type_.name}{IDL}"):
        if package.listed is not None and storage.is_file(package.root / type_.folder / name):
            return f"{type_.folder}/{name} exists, but {FILE} does not pass it to {GENERATE}"
    span = type_span(field) if field else None
    is_bare = span is not None and not _SEPARATOR.search(span.source.text, span.start, span.end)
    if is_bare and type_.name == "Header":
        return "write `std_msgs/Header`; `Header` alone works only in ROS 1"
    for folder, kind in (("srv", "a service"), ("action", "an action")):
        if package.interface(folder, type_.name):
            return f"{type_.package}/{folder}/{type_.name} is {kind}; the type of a field is always a message"
    if type_.folder == "msg" and type_.name.endswith(_PARTS):
        return "a part of a service or an action cannot be the type of a field: define a message for it"
    if is_bare and (owners := search.packages_with(type_.name)):
        return f"did you mean {' or '.join(f'`{owner}/{type_.name}`' for owner in owners[:3])}?"
    return did_you_mean(type_.name, package.names(type_.folder))


def label(field: Field | None) -> Label | None:
    """The place of the type of a field; None if rosidl has added the field."""
    span = type_span(field) if field else None
    return Label(span, "not found") if span else None
