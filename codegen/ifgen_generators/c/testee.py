"""The testee of the conformance suite: tables of all fields, for a program that is always the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ifgen.model import Constant, Field, Interface, Message, Model, Package

from ifgen_generators import c_family
from ifgen_generators.c.rows import c_name

_KINDS = {"bool": "b", "float32": "f", "float64": "f", "string": "s", "wstring": "w", "message": "m"}
_WIDTHS = {"bool": 1, "byte": 1, "char": 1}


def testee(model: Model) -> Iterator[tuple[str, str]]:
    """The files of the program: the tables of each package, and `main`."""
    packages = c_family.generated_packages(model)
    names = {message.type_name: c_name(message) for message in model.types}
    for package in packages:
        yield f"testee/{package.name}.c", _package(package, names)
    tables = [f"{package.name}_testee_types" for package in packages]
    lines = [
        '#include "testee.h"',
        "",
        *(f"extern const testee_type {table}[];" for table in tables),
        "",
        "int main(void)\n{",
        f"  static const testee_type *const packages[] = {{{', '.join([*tables, 'NULL'])}}};",
        '  return testee_main(packages, "c");\n}\n',
    ]
    yield "testee/main.c", "\n".join(lines)


def _package(package: Package, names: dict[str, str]) -> str:
    messages = [message for interface in package.interfaces for message in c_family.in_order(interface.types)]
    own = {message.type_name for message in messages}
    outside = {name for message in messages for name in message.dependencies} - own
    return "\n".join(
        [
            '#include "testee.h"',
            *(f'#include "{c_family.path(interface, "h")}"' for interface in package.interfaces),
            "",
            *(f"extern const testee_field {names[each]}_testee[];" for each in sorted(outside | own)),
            "",
            *(line for message in messages for line in _message(message, names)),
            f"extern const testee_type {package.name}_testee_types[];",
            f"const testee_type {package.name}_testee_types[] = {{",
            *(f"  {line}," for interface in package.interfaces for line in _types(interface)),
            "  {NULL, NULL, 0, 0, NULL, NULL, NULL, NULL, NULL},",
            "};\n",
        ]
    )


def _message(message: Message, names: dict[str, str]) -> Iterator[str]:
    name = c_name(message)
    yield f"const testee_field {name}_testee[] = {{"
    for field in message.fields:
        yield f"  {_field(field, name, names)},"
    yield "  {NULL, 0, 0, false, 0, 0, 0, 0, NULL},\n};"
    yield f"static const testee_constant {name}_constants[] = {{"
    for constant in message.constants:
        yield f"  {_constant(constant, name)},"
    yield "  {NULL, 0, 0, NULL},\n};"
    yield f"static void {name}_set(void *message)\n{{\n  {name}_init(message);\n}}\n"


def _field(field: Field, owner: str, names: dict[str, str]) -> str:
    type_, member = field.type, field.names["c"]
    is_sequence = type_.many and type_.size is None
    data = f"{member}.data" if is_sequence else member
    element = f"((const {owner} *)0)->{data}{'[0]' if type_.many else ''}"
    count = "0"
    if is_sequence:
        count = f"sizeof(((const {owner} *)0)->{data}) / sizeof({element})"
    elif type_.size is not None:
        count = str(type_.size)
    values = [
        f'"{field.name}"',
        f"'{_kind(type_.primitive)}'",
        str((type_.bits or 0) // 8),
        str(bool(is_sequence)).lower(),
        f"offsetof({owner}, {member})",
        f"offsetof({owner}, {data})",
        count,
        f"sizeof({element})",
        f"{names[type_.message.type_name]}_testee" if type_.message else "NULL",
    ]
    return f"{{{', '.join(values)}}}"


def _kind(primitive: str) -> str:
    return _KINDS.get(primitive, "i" if primitive.startswith("int") else "u")


def _constant(constant: Constant, owner: str) -> str:
    name, primitive = f"{owner}__{constant.name}", constant.type.primitive
    width = (constant.type.bits or 0) // 8
    match primitive:
        case "string":
            return f"{{\"{constant.name}\", 'z', 0, &{name}}}"
        case "wstring":
            return f"{{\"{constant.name}\", 'w', 0, {name}}}"
        case "float32" | "float64" | "uint32" | "int64" | "uint64":
            value = f"&{name}"
        case _:
            value = f"&(const {c_family.C_TYPES[primitive]}){{{name}}}"
    return f"{{\"{constant.name}\", '{_kind(primitive)}', {width}, {value}}}"


def _types(interface: Interface) -> Iterable[str]:
    for message in interface.types:
        name = c_name(message)
        sizes = f"sizeof({name}), {name}_MAX_SIZE"
        tables = ", ".join(f"{name}_{table}" for table in ("rows", "fields", "testee", "set", "constants"))
        yield f"{{{name}_TYPE_NAME, {name}_TYPE_HASH, {sizes}, {tables}}}"
    named = [service.name for service in interface.services] + [interface.name] * (interface.kind == "action")
    for of in named:
        name = f"{interface.package}__{interface.folder}__{of}"
        yield f"{{{name}_TYPE_NAME, {name}_TYPE_HASH, 0, 0, NULL, NULL, NULL, NULL, NULL}}"
