"""The codec of a class as Python text: `_serialize_Name(m)` and `_deserialize_Name(data)`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.body import Body, Constants, Reference, functions
from ifgen.generator_py.codec.decode import Decoder
from ifgen.generator_py.codec.encode import Encoder
from ifgen.generator_py.codec.parts import Parts
from ifgen.generator_py.codec.reads import HEADER, HEADER_SIZE, Reads
from ifgen.generator_py.codec.statements import LINE_LENGTH, POSITION, wrapped
from ifgen.generator_py.codec.table import Table, table_of
from ifgen.generator_py.names import class_reference
from ifgen.wire.positions import Alignment, entry_alignment, largest_alignment, tile_of
from ifgen.wire.program import NUMBERS, Call, Instruction, Program, Repeat, Values


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
    serialize = _serializer(program, constants, reference)
    deserialize = _deserializer(program, constants, reference)
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


def _serializer(program: Program, constants: Constants, reference: Reference) -> str:
    """The text of the function; of a large message, after that of those that it calls."""
    name = program.type.name
    before: list[str] = []
    if program.is_large:
        bodies = _writing_bodies(program, constants, reference)
        before += functions(f"_write_{name}", "m, out, p", bodies)
        body = Body()
        header = Parts(constants, body, Alignment(8, 0), needed=4)
        header.expect(HEADER)
        header.flush()
        body.do(f"out = [{header.joined()}]")
        body.do(f"_write_{name}(m, out, 0)")
        body.do('return b"".join(out)')
    else:
        body = _whole_body(program.groups[0], constants, reference)
    head = [f"def _serialize_{name}(m):", "    try:"]
    tail = ["    except Exception:", f"        return {constants.runtime('encode_any')}(m)"]
    return "\n\n".join([*before, "\n".join([*head, *body.lines(2), *tail])])


def _whole_body(instructions: Sequence[Instruction], constants: Constants, reference: Reference) -> Body:
    """The whole message at once."""
    body = Body()
    out = Parts(constants, body, Alignment(8, 0), max(4, largest_alignment(instructions)))
    in_list = any(
        isinstance(step, Call) or (isinstance(step, Repeat) and not tile_of(step.body))
        for step in instructions
    )
    if in_list:
        body.do("out = []")
    out.expect(HEADER)
    Encoder(out, constants, reference).write(instructions, following=1)
    out.flush()
    if in_list:
        out.emit()
        body.give('b"".join(out)')
    else:
        body.give(out.joined())
    return body


def _writing_bodies(program: Program, constants: Constants, reference: Reference) -> Iterator[Body]:
    """Group after group appended to `out`, at a position `p` that is right modulo 8."""
    behind = [*map(entry_alignment, program.groups[1:]), 1]
    alignment = Alignment(1, 0)
    for group, following in zip(program.groups, behind, strict=True):
        out = Parts(constants, Body(), alignment, needed=8)
        if group is program.groups[0]:
            out.align(entry_alignment(group))
        Encoder(out, constants, reference).write(group, following)
        out.flush()
        out.emit()
        alignment = out.alignment
        out.body.give(out.position)
        yield out.body


def _deserializer(program: Program, constants: Constants, reference: Reference) -> str:
    """The text of the function; of a large message, after that of those that it calls.

    Its input is `bytes` with the 4-byte header. This path knows little endian only and leaves, by any
    exception, as soon as something is not as a healthy peer sends it. `decode_any` then starts over, reads
    the other byte order, tolerates what compiled type supports tolerate, and names the field otherwise.

    If the message holds numeric sequences, the function has a second parameter, `views`: it makes them of
    their bytes (`ifgen_runtime.views.view_of`), or is None for copies.
    """
    name = program.type.name
    before: list[str] = []
    if program.is_large:
        bodies = _reading_bodies(program, constants, reference)
        before += functions(f"_read_{name}", "m, data, view, words, p", bodies)
    body = Body()
    source = Reads(constants, body, Alignment(8, 0), offset=HEADER_SIZE)
    may_view = _holds_sequences(program)
    decoder = Decoder(source, constants, reference, may_view=may_view)
    decoder.create(0, program.type)
    if program.is_large:
        source.flush()
        source.uses_words = True
        body.do(f"_read_{name}(m, data, view, words, {HEADER_SIZE})")
    else:
        decoder.read_all(program.groups[0])
    body.give("m")
    lines = [f"def _deserialize_{name}(data{', views=None' if may_view else ''}):", "    try:"]
    if source.uses_view or source.uses_words:
        lines.append("        view = memoryview(data)")
    if source.uses_words:
        lines.append('        words = view[: len(data) & -4].cast("I")')
    start_over = f"{constants.runtime('decode_any')}(data, {name}{', views' if may_view else ''})"
    tail = ["    except Exception:", f"        return {start_over}"]
    return "\n\n".join([*before, "\n".join([*lines, *body.lines(2), *tail])])


def _holds_sequences(program: Program) -> bool:
    """Whether the function reads numeric sequences by itself. What large messages read are copies."""
    instructions = [each for group in program.groups for each in _all_of(group)]
    return not program.is_large and (
        any(isinstance(each, Values) and NUMBERS[each.type].typecode for each in instructions)
        and not any(isinstance(each, Call) for each in instructions)
    )


def _all_of(instructions: Iterable[Instruction]) -> Iterator[Instruction]:
    """The instructions with those that they repeat."""
    for instruction in instructions:
        yield instruction
        if isinstance(instruction, Repeat):
            yield from _all_of(instruction.body)


def _reading_bodies(program: Program, constants: Constants, reference: Reference) -> Iterator[Body]:
    """Group after group filled in from the position `p` on."""
    alignment = Alignment(1, 0)
    for group in program.groups:
        source = Reads(constants, Body(), alignment, offset=None)
        Decoder(source, constants, reference).read_all(group)
        alignment = source.alignment
        source.body.give(POSITION)
        yield source.body
