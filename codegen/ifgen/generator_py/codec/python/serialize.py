"""Python text of the function that serialises a message: `_serialize_Name(m)`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ifgen.generator_py.codec.alignment import Alignment
from ifgen.generator_py.codec.positions import entry_alignment, largest_alignment, tile_of
from ifgen.generator_py.codec.program import Call, Instruction, Program, Repeat
from ifgen.generator_py.codec.python.body import Body, Constants
from ifgen.generator_py.codec.python.encode import Encoder
from ifgen.generator_py.codec.python.functions import Reference, functions
from ifgen.generator_py.codec.python.parts import Parts
from ifgen.generator_py.codec.python.pieces import HEADER


def serializer(program: Program, constants: Constants, reference: Reference) -> str:
    """The text of the function; of a large message, after that of those that it calls."""
    name = program.type.name
    before: list[str] = []
    if program.is_large:
        bodies = _group_bodies(program, constants, reference)
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


def _group_bodies(program: Program, constants: Constants, reference: Reference) -> Iterator[Body]:
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
