"""Messages of type_description_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from type_description_interfaces.msg._field import Field as Field
    from type_description_interfaces.msg._field_type import FieldType as FieldType
    from type_description_interfaces.msg._individual_type_description import (
        IndividualTypeDescription as IndividualTypeDescription,
    )
    from type_description_interfaces.msg._key_value import KeyValue as KeyValue
    from type_description_interfaces.msg._type_description import TypeDescription as TypeDescription
    from type_description_interfaces.msg._type_source import TypeSource as TypeSource

__all__ = [
    "Field",
    "FieldType",
    "IndividualTypeDescription",
    "KeyValue",
    "TypeDescription",
    "TypeSource",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Field": "_field",
        "FieldType": "_field_type",
        "IndividualTypeDescription": "_individual_type_description",
        "KeyValue": "_key_value",
        "TypeDescription": "_type_description",
        "TypeSource": "_type_source",
    },
)
