"""The codec of a class as Python text."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.program import Program
from ifgen.generator_py.codec.python.body import Constants
from ifgen.generator_py.codec.python.deserialize import deserializer
from ifgen.generator_py.codec.python.lines import LINE_LENGTH, wrapped
from ifgen.generator_py.codec.python.serialize import serializer
from ifgen.generator_py.codec.table import Table, table_of
from ifgen.generator_py.names import class_reference


@dataclass(frozen=True, slots=True)
class CodecText:
    """The codec of one class, to be placed behind the classes of its module.

    Import `runtime_imports` from `ifgen_runtime.codec`, and the classes of `class_types` that are of other
    modules under the names that `class_reference` gives them. Then come the `constants` (assignments at
    module level), the functions `serialize` and `deserialize` (whole text without annotations, named
    `_serialize_<ClassName>` and `_deserialize_<ClassName>`; those that they call stand before them), and last
    the statements `attachment`, which hang them on the class.
    """

    runtime_imports: tuple[str, ...]
    class_types: tuple[NamespacedType, ...]
    constants: tuple[str, ...]
    serialize: str
    deserialize: str
    attachment: str


def render(program: Program) -> CodecText:
    """Render the codec of a message."""

    def reference(type_: NamespacedType) -> str:
        return class_reference(type_, program.type)

    name, nested = program.type.name, tuple(program.nested)
    constants = Constants(name)
    serialize = serializer(program, constants, reference)
    deserialize = deserializer(program, constants, reference)
    own = [reference(holder.type) for holder in nested if holder.slot.message == 0]
    arguments = ", ".join([name, f"_serialize_{name}", f"_deserialize_{name}", *own])
    attachment = _with_table(f"{constants.runtime('attach_codec')}({arguments}", table_of(program), reference)
    if program.is_large:
        attach_parts = f"{constants.runtime('attach_parts')}({name}, _write_{name}, _read_{name})"
        attachment += wrapped(attach_parts, 0)
    return CodecText(
        runtime_imports=constants.imported,
        class_types=tuple(dict.fromkeys(holder.type for holder in nested)),
        constants=constants.lines,
        serialize=serialize,
        deserialize=deserialize,
        attachment="\n".join(attachment),
    )


def _with_table(call: str, table: Table, reference: Callable[[NamespacedType], str]) -> list[str]:
    """The lines of a call whose last argument is the table; its text is broken between rows."""
    classes = [f"{reference(type_)}," for type_ in table.types]
    text = f'"{" ".join(table.rows)}",'
    line = f"{call}, table=({' '.join([text, *classes])}))"
    if len(line) <= LINE_LENGTH:
        return [line]
    *texts, last = _packed(table.rows, LINE_LENGTH - len('    "" ,'))
    literals = [*(f'"{text} "' for text in texts), f'"{last}",']
    indented = [f"    {line}" for line in (*literals, *_packed(classes, LINE_LENGTH - 4))]
    return [*wrapped(f"{call}, table=(", 0), *indented, "))"]


def _packed(words: Iterable[str], room: int) -> list[str]:
    """The words with spaces between them, as many on each line as there is room for."""
    lines: list[str] = []
    for word in words:
        if lines and len(lines[-1]) + 1 + len(word) <= room:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines
