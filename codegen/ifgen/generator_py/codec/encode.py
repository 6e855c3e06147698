"""Plan the function that serialises a message: `_serialize_Name(m)`, a straight line over its slots.

Its form. Each part was measured (benchmarks/codec.py):

* what has a fixed layout is packed by one precomputed `struct.Struct` a run; where the position before it is
  only known in part, by one from a table, chosen by the position;
* strings come from a memory of their wire forms, padded to 4 bytes where that is what follows anyway; one
  between two runs is packed with them, by a Struct for its size;
* arrays go to `bytes.join` unchanged, so that a blob is copied once.

Only values of exactly the expected kind stay on this path. Anything else raises something, and the function
starts over with `encode_any`, which accepts what can be accepted and names the field otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import assert_never

from ifgen.definition.types import BasicTypeName, NamespacedType
from ifgen.generator_py.codec.alignment import Alignment, RunItem, run_format
from ifgen.generator_py.codec.layout import (
    NUMBERS,
    Apart,
    Count,
    Messages,
    Nested,
    Placeholder,
    Scalar,
    Scalars,
    Step,
    Text,
    Texts,
    entry_alignment,
    fixed_elements,
    following_alignments,
    largest_alignment,
)
from ifgen.generator_py.codec.parts import HEADER, HEADER_VALUE, Parts, packed
from ifgen.generator_py.codec.text import Body, Constants, functions

_LARGE_ARRAY = 256
_WIRES: dict[BasicTypeName, str] = {
    "boolean": "booleans_wire",
    "octet": "octets_wire",
    "char": "characters_wire",
}


class Encoder:
    """Plans one serialising function."""

    def __init__(
        self,
        constants: Constants,
        reference: Callable[[NamespacedType], str],
        heads: dict[tuple[int, Alignment, int], Alignment] | None = None,
    ) -> None:
        self._constants = constants
        self._runtime = constants.runtime
        self._reference = reference
        # Loops by the identity of their step: without it, each level of nesting would multiply the work.
        self._heads = {} if heads is None else heads

    def plan(self, class_name: str, groups: Sequence[tuple[Step, ...]], *, is_large: bool) -> str:
        """The text of the function; of a large message, after the functions that it calls."""
        body = Body()
        before: list[str] = []
        if is_large:
            before += functions(f"_write_{class_name}", "m, out, p", self._in_groups(groups))
            header = packed(self._constants, HEADER.format, [HEADER_VALUE])
            body.add(f"out = [{header}]")
            body.add(f"_write_{class_name}(m, out, 0)")
            body.add('return b"".join(out)')
        else:
            self._at_once(body, *groups)
        head = f"def _serialize_{class_name}(m):"
        tail = ["    except Exception:", f"        return {self._runtime('encode_any')}(m)"]
        return "\n\n".join([*before, "\n".join([head, "    try:", *body.lines(2), *tail])])

    def _at_once(self, body: Body, steps: tuple[Step, ...]) -> None:
        """The whole message."""
        needed = max(4, largest_alignment(steps))
        self._out = Parts(self._constants, body, Alignment(8, 0), needed)
        in_list = any(isinstance(step, Apart) or _is_loop(step) for step in steps)
        if in_list:
            body.add("out = []")
        self._out.expect(HEADER)
        self._steps(steps, following=1)
        self._out.flush()
        if in_list:
            self._out.emit()
            body.give('b"".join(out)')
        else:
            body.give(self._out.joined())

    def _in_groups(self, groups: Sequence[tuple[Step, ...]]) -> Iterator[Body]:
        """Group after group appended to `out`, at a position `p` that is right modulo 8."""
        behind = [*map(entry_alignment, groups[1:]), 1]
        alignment = Alignment(1, 0)
        for group, following in zip(groups, behind, strict=True):
            body = Body()
            self._out = Parts(self._constants, body, alignment, needed=8)
            if group is groups[0]:
                self._out.align(entry_alignment(group))
            self._steps(group, following)
            self._out.flush()
            self._out.emit()
            alignment = self._out.alignment
            body.give("p" if self._out.is_tracked else str(alignment.remainder))
            yield body

    def _steps(self, steps: Sequence[Step], following: int) -> None:
        """Write the steps; `following` is the alignment of what comes after them, 1 at the end."""
        for step, after in zip(steps, following_alignments(steps, following), strict=True):
            self._step(step, after)

    def _step(self, step: Step, following: int) -> None:
        match step:
            case Nested(target, variable, type_):
                self._out.refuse(self._is_no(f"({variable} := {target})", type_))
            case Placeholder():
                self._out.expect(RunItem("x", 1, 1, None))
            case Scalar(target, type_):
                number = NUMBERS[type_]
                refusals, value = self._checked_scalar(target, type_)
                self._out.refuse(*refusals)
                self._out.expect(RunItem(number.format, number.size, number.size, value))
            case Text():
                self._text(step, following)
            case Scalars(type=("boolean" | "octet" | "char")):
                self._flags(step)
            case Scalars(count=Count(size=int(size))):
                self._fixed_numbers(step, size)
            case Scalars():
                self._numbers(step)
            case Texts():
                self._texts(step, following)
            case Messages():
                self._messages(step, following)
            case Apart():
                self._apart(step)
            case _:
                assert_never(step)

    def _is_no(self, value: str, type_: NamespacedType) -> str:
        return f"{value}.__class__ is not {self._reference(type_)}"

    def _checked_scalar(self, target: str, type_: BasicTypeName) -> tuple[list[str], str]:
        """Conditions that refuse the value, and what to pack. `struct` itself checks integers and octets."""
        if type_ == "char":
            return [], f'{target}.encode("latin-1")'
        if type_ not in ("boolean", "float", "double"):
            return [], target
        expected = "bool" if type_ == "boolean" else "float"
        value = self._out.name("x")
        return [f"({value} := {target}).__class__ is not {expected}"], value

    def _text(self, step: Text, following: int) -> None:
        value = step.target
        if step.maximum is not None:
            value = self._out.name("s")
            self._out.refuse(f"len({value} := {step.target}) > {step.maximum}")
        if step.wide:
            self._out.align(4)
            self._write(f"{self._runtime('wstring_wire')}({value})", Alignment(4, 0))
        else:
            self._out.add_text(value, padded=following >= 4)

    def _write(self, expression: str, end: Alignment) -> None:
        """Write bytes that are made now."""
        part = self._out.name("part")
        self._out.body.add(f"{part} = {expression}")
        self._out.add_part(part)
        self._out.jump(f"len({part})", end)

    # Arrays and sequences

    def _counted(self, step: Scalars | Texts | Messages) -> str:
        """Load the collection, check and write its count; the name of the collection."""
        elements = self._out.name("a")
        if isinstance(step, Scalars) and NUMBERS[step.type].typecode:
            self._out.refuse(f'({elements} := {step.target}).typecode != "{NUMBERS[step.type].typecode}"')
        else:
            self._out.refuse(f"({elements} := {step.target}).__class__ is not list")
        if step.count.size is not None:
            self._out.refuse(f"len({elements}) != {step.count.size}")
            return elements
        if step.count.maximum is not None:
            self._out.refuse(f"len({elements}) > {step.count.maximum}")
        self._out.expect(RunItem("I", 4, 4, f"len({elements})"))
        return elements

    def _flags(self, step: Scalars) -> None:
        """Booleans, octets and characters are lists."""
        elements = self._counted(step)
        self._out.flush()
        size = step.count.size
        end = Alignment(1, 0) if size is None else self._out.alignment.advanced(size)
        self._write(f"{self._runtime(_WIRES[step.type])}({elements})", end)

    def _fixed_numbers(self, step: Scalars, size: int) -> None:
        number = NUMBERS[step.type]
        elements, total = self._out.name("a"), size * number.size
        dtype = f"{self._runtime('numeric')}.{number.dtype}"
        self._out.refuse(f"({elements} := {step.target}).dtype is not {dtype}")
        if total > _LARGE_ARRAY:
            self._out.refuse(f"{elements}.nbytes != {total}")
            self._out.align(number.size)
            self._out.add_part(elements)
            self._out.jump(str(total), self._out.alignment.advanced(total))
            return
        packed = self._out.name("b")
        self._out.refuse(f"len({packed} := {elements}.tobytes()) != {total}")
        self._out.expect(RunItem(f"{total}s", number.size, total, packed))

    def _numbers(self, step: Scalars) -> None:
        number = NUMBERS[step.type]
        elements = self._counted(step)
        self._out.flush()
        if number.size == 8:
            self._align_elements(elements)
        self._out.add_part(elements)
        self._out.jump(_product(f"len({elements})", number.size), Alignment(min(number.size, 4), 0))

    def _align_elements(self, elements: str) -> None:
        """Pad a sequence of 8-byte elements after its count; an empty one is not padded."""
        if not self._out.alignment.is_aligned(8):
            needed = f"{elements} and p & 4" if self._out.is_tracked else elements
            self._write(f'{self._runtime("four_zeros")} if {needed} else b""', Alignment(4, 0))

    def _texts(self, step: Texts, following: int) -> None:
        elements = self._counted(step)
        if step.maximum is not None:
            self._out.refuse(f"{self._runtime('any_longer')}({elements}, {step.maximum})")
        self._out.align(4)
        kind = "w" if step.wide else "padded_" if following >= 4 else ""
        wire = self._runtime(f"{kind}strings_wire")
        self._write(f"{wire}({elements})", Alignment(4 if kind else 1, 0))

    # Messages in arrays and sequences

    def _messages(self, step: Messages, following: int) -> None:
        elements = self._counted(step)
        fixed = fixed_elements(step.steps)
        if fixed is None:
            self._each_message(step, elements, following)
        else:
            self._packed_messages(step, elements, *fixed)

    def _packed_messages(
        self, step: Messages, elements: str, items: list[RunItem], alignment: int, size: int
    ) -> None:
        """Elements of one fixed layout: a list of packed ones, without those of a wrong kind."""
        if step.count.size is not None:
            self._out.align(alignment)
        else:
            self._out.flush()
            if alignment == 8:
                self._align_elements(elements)
        refusals = [self._is_no(step.variable, step.type)]
        arguments: list[str] = []
        for inner in step.steps:
            if isinstance(inner, Nested):
                refusals.append(self._is_no(f"({inner.variable} := {inner.target})", inner.type))
            elif isinstance(inner, Scalar):
                refused, value = self._checked_scalar(inner.target, inner.type)
                refusals.extend(refused)
                arguments.append(value)
        accepted = " and ".join(refusal.replace(" is not ", " is ") for refusal in refusals)
        packed = self._out.packed(run_format(items, 0)[0], arguments)
        parts = self._out.name("parts")
        self._out.body.add(f"{parts} = [{packed} for {step.variable} in {elements} if {accepted}]")
        self._out.body.refuse([f"len({parts}) != len({elements})"])
        self._out.add_part(f"*{parts}")
        if step.count.size is not None:
            total = step.count.size * size
            self._out.jump(str(total), self._out.alignment.advanced(total))
        else:
            self._out.jump(_product(f"len({elements})", size), Alignment(min(alignment, 4), 0))

    def _each_message(self, step: Messages, elements: str, following: int) -> None:
        """Elements of varying layout: a loop that appends their parts to `out`."""
        self._out.flush()
        self._out.emit()
        entry, last = entry_alignment(step.steps), step.steps[-1]
        # An element that begins 4-aligned may follow a padded string. The padding after the last one is
        # removed.
        padded = entry >= 4 and isinstance(last, Text) and not last.wide
        inner_following = entry if padded else 1
        start = self._out.alignment
        head = self._settled(start, step, inner_following)
        self._forget_down_to(head)
        with self._out.body.block(f"for {step.variable} in {elements}:"):
            self._element(step, inner_following)
            self._forget_down_to(head)
        if padded and following < 4 and isinstance(last, Text):
            self._cut_padding(last, elements)

    def _apart(self, step: Apart) -> None:
        """A message that writes itself."""
        self._out.flush()
        self._out.emit()
        write = self._constants.name(f"{self._runtime('writer_of')}({self._reference(step.type)})")
        position = "p" if self._out.is_tracked else str(self._out.alignment.remainder)
        self._out.body.add(f"p = {write}({step.variable}, out, {position})")
        self._out.alignment = Alignment(1, 0)

    def _forget_down_to(self, head: Alignment) -> None:
        """Know as little about the position as at the head of the loop; `p` begins where it is needed."""
        if head.modulus < self._out.needed and not self._out.is_tracked:
            self._out.body.place(str(self._out.alignment.remainder))
        self._out.alignment = head

    def _element(self, step: Messages, following: int) -> None:
        self._out.refuse(self._is_no(step.variable, step.type))
        self._steps(step.steps, following)
        self._out.flush()
        self._out.emit()

    def _settled(self, start: Alignment, step: Messages, following: int) -> Alignment:
        """The knowledge at the head of the loop: it holds before the first element and after each."""
        known = id(step), start, following
        if known not in self._heads:
            trial = Encoder(Constants(""), self._reference, self._heads)
            trial._out = Parts(trial._constants, Body(), start, self._out.needed)
            trial._element(step, following)
            settled = start.either(trial._out.alignment)
            self._heads[known] = start if settled == start else self._settled(settled, step, following)
        return self._heads[known]

    def _cut_padding(self, last: Text, elements: str) -> None:
        self._forget_down_to(Alignment(1, 0))
        with self._out.body.block(f"if {elements}:"):
            self._out.body.add(f"out[-1] = {self._runtime('wire')}[{last.target}]")
            self._out.body.move(f"len(out[-1]) - len({self._runtime('padded_wire')}[{last.target}])")


def _is_loop(step: Step) -> bool:
    return isinstance(step, Messages) and not fixed_elements(step.steps)


def _product(count: str, size: int) -> str:
    return count if size == 1 else f"{count} * {size}"
