"""A class from a type description."""

from __future__ import annotations

from typing import Any

from ifgen.definition.described.reading import read
from ifgen.diagnostics import InputError
from ifgen.dynamic import texts
from ifgen.dynamic.asking import TypeDescription
from ifgen.dynamic.documents import document_from
from ifgen.dynamic.making import make


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
        return make(*read(document_from(description), type_hash))
    type_hash = type_hash or description.type_hash
    described, registry = read(description.document, type_hash)
    if any(text for _, _, text in description.sources):
        try:
            cls = texts.class_from_sources(description.type_name, description.sources)
        except InputError:  # a node may have installed what it was not built with
            pass
        else:
            if cls is not None and cls.__type_hash__ == type_hash:
                return cls
    return make(described, registry)
