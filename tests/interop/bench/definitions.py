"""Definitions for programs that have none: a folder as ROS installs them, and the shapes of messages."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ifgen import resources
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.type_description import Described, describe, described_types, type_hash
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)
from ifgen.pipeline.lookup import find_type
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath


def install(types: Iterable[str], folder: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Write what is known of types into a folder, and return the shapes of their messages, and their hashes.

    The folder gets `share/<package>` with all definitions of ours, and the type descriptions of `types`. A
    shape has for each field the name of its type, a shape, or a list of either.
    """
    shutil.copytree(resources.bundled_interfaces(), folder / "share", dirs_exist_ok=True)
    search = SearchPath(find_packages((resources.bundled_interfaces(),)), ())
    shapes: dict[str, Any] = {}
    hashes: dict[str, str] = {}
    for name in types:
        found, registry = find_type(name, search)
        parts = _parts(found)
        own = {part.type_name: type_hash(part, registry) for part in parts}
        hashes |= own
        shapes |= {part.type_name: _shape(part, registry) for part in parts if isinstance(part, Message)}
        document = {
            "type_description_msg": describe(found, registry),
            "type_hashes": [{"type_name": part, "hash_string": text} for part, text in own.items()],
        }
        (folder / "share" / f"{name}.json").write_text(json.dumps(document), encoding="utf-8")
    return shapes, hashes


def _parts(found: Described) -> list[Described]:
    return [found] if isinstance(found, Message) else list(described_types(found))


def _shape(message: Message, registry: Registry) -> dict[str, Any]:
    return {field.name: _shape_of(field.type, registry) for field in message.fields}


def _shape_of(type_: FieldType, registry: Registry) -> Any:
    match type_:
        case BasicType():
            return type_.typename
        case NamespacedType():
            return _shape(registry.message(type_.type_name), registry)
        case Array() | BoundedSequence() | UnboundedSequence():
            return [_shape_of(type_.value_type, registry)]
        case _:
            return "string"
