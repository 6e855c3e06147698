"""Names in generated Python: modules, classes, attributes and slots."""

from __future__ import annotations

from typing import TypeAlias

from ifgen.definition.interfaces import Field, Interface
from ifgen.definition.names import attribute_name, snake_case
from ifgen.definition.types import NamespacedType

# Parts of an interface share its module; longer suffixes come first, since one can end in another.
_PART_SUFFIXES = {
    "srv": ("_Request", "_Response", "_Event"),
    "action": (
        *("_SendGoal_Request", "_SendGoal_Response", "_SendGoal_Event", "_SendGoal"),
        *("_GetResult_Request", "_GetResult_Response", "_GetResult_Event", "_GetResult"),
        *("_FeedbackMessage", "_Goal", "_Result", "_Feedback"),
    ),
}


TypeName: TypeAlias = Interface | NamespacedType


def module_name(interface_name: str) -> str:
    """The module of an interface, by rosidl's rule: `PointCloud2` is in `_point_cloud2`."""
    return f"_{snake_case(interface_name)}"


def interface_name(type_name: TypeName) -> str:
    """The interface that a message belongs to: `AddTwoInts` for `AddTwoInts_Request`."""
    for suffix in _PART_SUFFIXES.get(type_name.folder, ()):
        if type_name.name.endswith(suffix):
            return type_name.name.removesuffix(suffix)
    return type_name.name


def class_reference(target: TypeName, home: TypeName) -> str:
    """The name of the class `target` in the module of `home`.

    `Name` within the module, `geometry_msgs_msg_Vector3` for a class that it imports: package and folder keep
    classes of one name apart, and no class, field or constant can be called so.
    """
    if _module_of(target) == _module_of(home):
        return target.name
    return f"{target.package}_{target.folder}_{target.name}"


def _module_of(type_name: TypeName) -> tuple[str, str, str]:
    return type_name.package, type_name.folder, interface_name(type_name)


def slot_name(field: Field) -> str:
    """The private attribute of a field, which reaches the value whatever the public one does: `_x`."""
    return f"_{attribute_name(field)}"


def enum_name(field: Field) -> str:
    """The class of the constants that a field can hold: `PowerSupplyStatusEnum` for `power_supply_status`."""
    return "".join(word[:1].upper() + word[1:] for word in field.name.split("_")) + "Enum"
