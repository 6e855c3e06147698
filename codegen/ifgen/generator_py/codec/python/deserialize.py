"""Python text of the function that deserialises a message: `_deserialize_Name(data)`.

If the message holds numeric sequences, the function has a second parameter, `views`. It is what makes these
sequences of their bytes (`ifgen_runtime.views.view_of`), or None for copies.

Its input is `bytes` with the 4-byte header. This path knows little endian only and leaves, by any exception,
as soon as something is not as a healthy peer sends it; `decode_any` then starts over, reads the other byte
order, tolerates what compiled type supports tolerate, and names the field otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ifgen.generator_py.codec.alignment import Alignment
from ifgen.generator_py.codec.program import NUMBERS, Call, Instruction, Program, Repeat, Values
from ifgen.generator_py.codec.python.body import Body, Constants
from ifgen.generator_py.codec.python.code import POSITION
from ifgen.generator_py.codec.python.decode import Decoder
from ifgen.generator_py.codec.python.functions import Reference, functions
from ifgen.generator_py.codec.python.pieces import HEADER_SIZE
from ifgen.generator_py.codec.python.reads import Reads


def deserializer(program: Program, constants: Constants, reference: Reference) -> str:
    """The text of the function; of a large message, after that of those that it calls."""
    name = program.type.name
    before: list[str] = []
    if program.is_large:
        bodies = _group_bodies(program, constants, reference)
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


def _group_bodies(program: Program, constants: Constants, reference: Reference) -> Iterator[Body]:
    """Group after group filled in from the position `p` on."""
    alignment = Alignment(1, 0)
    for group in program.groups:
        source = Reads(constants, Body(), alignment, offset=None)
        Decoder(source, constants, reference).read_all(group)
        alignment = source.alignment
        source.body.give(POSITION)
        yield source.body
