"""Plan the function that serialises a message: `_serialize_Name(m) -> bytes`, a straight line over its slots.

Its form, each part of which was measured:

* what has a fixed layout is packed by one precomputed `struct.Struct` a run; where the position before it is
  only known in part, by a table of them, indexed by the position;
* `p` is any number that equals the position modulo 8, and is kept only where something reads it;
* strings come from a cache of their wire form, padded to 4 bytes where that is what follows anyway;
* arrays are handed to `bytes.join` as they are, so that a blob is copied once.

Only values of exactly the expected kind stay on this path. Anything else raises something, and the function
starts over with `encode_any`, which accepts what can be accepted and names the field otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from ifgen.definition.types import BasicTypeName, NamespacedType
from ifgen.generator_py.codec.layout import (
    NUMBERS,
    Alignment,
    Count,
    Messages,
    Nested,
    Placeholder,
    RunItem,
    Scalar,
    Scalars,
    Step,
    Text,
    Texts,
    after_run,
    entry_alignment,
    fixed_elements,
    largest_alignment,
    run_format,
)
from ifgen.generator_py.codec.text import Body, Constants

_LITTLE_ENDIAN_HEADER = RunItem("I", 1, 0, "256")
_LARGE_ARRAY = 256


class Encoder:
    """Plans one serialising function."""

    def __init__(self, constants: Constants, reference: Callable[[NamespacedType], str]) -> None:
        self._constants = constants
        self._reference = reference
        self._body = Body()
        self._refusals: list[str] = []
        self._run: list[RunItem] = []
        self._parts: list[str] = []
        self._alignment = Alignment(8, 0)
        self._needed = 8
        self._in_list = False
        self._names = 0

    def plan(self, class_name: str, steps: tuple[Step, ...]) -> str:
        """The text of the function."""
        self._needed = max(4, largest_alignment(steps))
        self._in_list = any(isinstance(step, Messages) and not fixed_elements(step.steps) for step in steps)
        if self._in_list:
            self._body.add("out: list[Any] = []")
        self._run.append(_LITTLE_ENDIAN_HEADER)
        self._steps(steps, following=1)
        self._finish()
        return "\n".join(
            [
                f"def _serialize_{class_name}(m: Any) -> bytes:",
                "    try:",
                *self._body.lines(2),
                "    except Exception:",
                "        return encode_any(m)",
            ]
        )

    def _finish(self) -> None:
        self._flush()
        if self._in_list:
            self._emit_parts()
            self._body.add('return b"".join(out)')
        elif len(self._parts) == 1 and not self._parts[0].startswith("*"):
            self._body.add(f"return {self._parts[0]}")
        else:
            self._body.add(f'return b"".join(({", ".join(self._parts)}))')

    def _name(self, prefix: str) -> str:
        self._names += 1
        return f"{prefix}{self._names}"

    # What is known about the position

    @property
    def _tracked(self) -> bool:
        """Whether the position has to be kept in `p`, since less is known about it than may be needed."""
        return self._alignment.modulus < self._needed

    def _jump(self, distance: str, end: Alignment) -> None:
        """Note that a number of bytes known only at run time was written."""
        if end.modulus >= self._needed:
            self._alignment = end
            return
        if self._tracked:
            self._body.move(distance)
        else:
            start = self._alignment.remainder
            self._body.place(f"{start} + {distance}" if start else distance)
        self._alignment = end

    # Runs of fixed layout

    def _flush(self) -> None:
        """Write the pending items: one part, packed at once."""
        self._body.refuse(self._refusals)
        run, start = self._run, self._alignment
        self._refusals, self._run = [], []
        if not run:
            return
        end = after_run(run, start)
        arguments = ", ".join(item.expression for item in run if item.expression is not None)
        largest = max(item.alignment for item in run)
        if largest <= start.modulus:
            text, size = run_format(run, start.remainder)
            if size or run[0] is _LITTLE_ENDIAN_HEADER:
                self._parts.append(self._packed(text, arguments))
            if self._tracked and end.modulus < self._needed:
                self._body.move(str(size))
            self._alignment = end
            return
        self._flush_by_table(run, largest, arguments, end)

    def _packed(self, text: str, arguments: str) -> str:
        if not arguments:
            return self._constants.name(f'packer("<{text}")()')
        return f"{self._constants.layout('packer', text)}({arguments})"

    def _flush_by_table(self, run: list[RunItem], largest: int, arguments: str, end: Alignment) -> None:
        step = self._alignment.modulus
        starts = range(self._alignment.remainder, largest, step)
        layouts = {start: run_format(run, start) for start in starts}
        part = self._name("part")
        table = ", ".join(f'{start}: "<{text}"' for start, (text, _) in layouts.items())
        maker = "packers" if arguments else "paddings"
        index = f"[p & {largest - 1}]"
        call = f"({arguments})" if arguments else ""
        self._body.add(f"{part} = {self._constants.name(f'{maker}({{{table}}})')}{index}{call}")
        self._parts.append(part)
        if end.modulus < self._needed:
            self._body.move(f"len({part})")
        self._alignment = end

    def _align(self, alignment: int) -> None:
        """Pad now."""
        if not after_run(self._run, self._alignment).is_aligned(alignment):
            self._run.append(RunItem("", alignment, 0, None))
        self._flush()

    # Steps

    def _steps(self, steps: Sequence[Step], following: int) -> None:
        """Write the steps; `following` is the alignment of what comes after them, 1 at the end."""
        for index, step in enumerate(steps):
            rest = tuple(steps[index + 1 :])
            has_more = any(not isinstance(other, Nested) for other in rest)
            self._step(step, entry_alignment(rest) if has_more else following)

    def _step(self, step: Step, following: int) -> None:
        match step:
            case Nested(target, variable, type_):
                self._refusals.append(f"not isinstance({variable} := {target}, {self._reference(type_)})")
            case Placeholder():
                self._run.append(RunItem("x", 1, 1, None))
            case Scalar(target, type_):
                self._scalar(target, type_)
            case Text():
                self._text(step, following)
            case Scalars(type=("boolean" | "octet")):
                self._flags(step)
            case Scalars(count=Count(size=int(size))):
                self._fixed_numbers(step, size)
            case Scalars():
                self._numbers(step)
            case Texts():
                self._texts(step, following)
            case Messages():
                self._messages(step, following)
            case _:
                assert_never(step)

    def _scalar(self, target: str, type_: BasicTypeName) -> None:
        number = NUMBERS[type_]
        refusal, expression = self._checked_scalar(target, type_)
        self._refusals.extend(refusal)
        self._run.append(RunItem(number.format, number.size, number.size, expression))

    def _checked_scalar(self, target: str, type_: BasicTypeName) -> tuple[list[str], str]:
        """Conditions that refuse the value, and what to pack. `struct` itself checks integers and octets."""
        if type_ not in ("boolean", "float", "double"):
            return [], target
        expected = "bool" if type_ == "boolean" else "float"
        value = self._name("x")
        return [f"({value} := {target}).__class__ is not {expected}"], value

    def _text(self, step: Text, following: int) -> None:
        value = step.target
        if step.maximum is not None:
            value = self._name("s")
            self._refusals.append(f"len({value} := {step.target}) > {step.maximum}")
        self._align(4)
        part = self._name("part")
        if step.wide:
            self._body.add(f"{part} = wstring_wire({value})")
        else:
            self._body.add(f"{part} = {'padded_wire' if following >= 4 else 'wire'}[{value}]")
        self._parts.append(part)
        self._jump(f"len({part})", Alignment(4, 0) if step.wide or following >= 4 else Alignment(1, 0))

    def _counted(self, step: Scalars | Texts | Messages) -> str:
        """Load the collection, check and write its count; the name of the collection."""
        elements = self._name("a")
        if isinstance(step, Scalars) and step.type not in ("boolean", "octet"):
            typecode = NUMBERS[step.type].typecode
            self._refusals.append(f'({elements} := {step.target}).typecode != "{typecode}"')
        else:
            self._refusals.append(f"({elements} := {step.target}).__class__ is not list")
        if step.count.size is not None:
            self._refusals.append(f"len({elements}) != {step.count.size}")
            return elements
        if step.count.maximum is not None:
            self._refusals.append(f"len({elements}) > {step.count.maximum}")
        self._run.append(RunItem("I", 4, 4, f"len({elements})"))
        return elements

    def _flags(self, step: Scalars) -> None:
        """Booleans and octets are lists."""
        elements = self._counted(step)
        part = self._name("part")
        self._flush()
        self._body.add(f"{part} = {'booleans' if step.type == 'boolean' else 'octets'}_wire({elements})")
        self._parts.append(part)
        if step.count.size is None:
            self._jump(f"len({part})", Alignment(1, 0))
        else:
            self._jump(str(step.count.size), self._alignment.advanced(step.count.size))

    def _fixed_numbers(self, step: Scalars, size: int) -> None:
        number = NUMBERS[step.type]
        elements, total = self._name("a"), size * number.size
        self._refusals.append(f"({elements} := {step.target}).dtype is not numeric.{number.dtype}")
        if total > _LARGE_ARRAY:
            self._refusals.append(f"{elements}.nbytes != {total}")
            self._align(number.size)
            self._parts.append(elements)
            self._jump(str(total), self._alignment.advanced(total))
            return
        packed = self._name("b")
        self._refusals.append(f"len({packed} := {elements}.tobytes()) != {total}")
        self._run.append(RunItem(f"{total}s", number.size, total, packed))

    def _numbers(self, step: Scalars) -> None:
        number = NUMBERS[step.type]
        elements = self._counted(step)
        self._flush()
        if number.size == 8:
            self._align_elements(elements)
        self._parts.append(elements)
        distance = f"len({elements})" + (f" * {number.size}" if number.size > 1 else "")
        self._jump(distance, Alignment(min(number.size, 4), 0))

    def _align_elements(self, elements: str) -> None:
        """Pad a sequence of 8-byte elements after its count; an empty one is not padded."""
        if self._alignment.is_aligned(8):
            return
        needed = f"{elements} and p & 4" if self._tracked else elements
        part = self._name("part")
        self._body.add(f'{part} = four_zeros if {needed} else b""')
        self._parts.append(part)
        self._jump(f"len({part})", Alignment(4, 0))

    def _texts(self, step: Texts, following: int) -> None:
        elements = self._counted(step)
        if step.maximum is not None:
            self._refusals.append(f"any_longer({elements}, {step.maximum})")
        self._align(4)
        part = self._name("part")
        kind = "w" if step.wide else "padded_" if following >= 4 else ""
        self._body.add(f"{part} = {kind}strings_wire({elements})")
        self._parts.append(part)
        self._jump(f"len({part})", Alignment(4 if step.wide or following >= 4 else 1, 0))

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
        if step.count.size is None:
            self._flush()
            if alignment == 8:
                self._align_elements(elements)
        else:
            self._align(alignment)
        conditions = [f"isinstance({step.variable}, {self._reference(step.type)})"]
        arguments: list[str] = []
        for inner in step.steps:
            if isinstance(inner, Nested):
                conditions.append(
                    f"isinstance({inner.variable} := {inner.target}, {self._reference(inner.type)})"
                )
            elif isinstance(inner, Scalar):
                refusal, expression = self._checked_scalar(inner.target, inner.type)
                conditions.extend(condition.replace(" is not ", " is ") for condition in refusal)
                arguments.append(expression)
        packed = self._packed(run_format(items, 0)[0], ", ".join(arguments))
        parts = self._name("parts")
        self._body.add(
            f"{parts} = [{packed} for {step.variable} in {elements} if {' and '.join(conditions)}]"
        )
        self._body.refuse([f"len({parts}) != len({elements})"])
        self._parts.append(f"*{parts}")
        if step.count.size is None:
            distance = f"len({elements})" + (f" * {size}" if size > 1 else "")
            self._jump(distance, Alignment(min(alignment, 4), 0))
        else:
            self._jump(str(step.count.size * size), self._alignment.advanced(step.count.size * size))

    def _each_message(self, step: Messages, elements: str, following: int) -> None:
        """Elements of varying layout: a loop that appends their parts to `out`."""
        self._flush()
        self._emit_parts()
        entry = entry_alignment(step.steps)
        last = step.steps[-1]
        ends_in_text = isinstance(last, Text) and not last.wide
        # An element that begins 4-aligned may follow a padded string; behind the last one the padding goes.
        inner_following = entry if entry >= 4 and ends_in_text else 1
        start = self._alignment
        head = self._settled(start, step, inner_following)
        if head.modulus < self._needed and not self._tracked:
            self._body.place(str(start.remainder))
        with self._body.block(f"for {step.variable} in {elements}:"):
            self._alignment = head
            self._element(step, inner_following)
            if head.modulus < self._needed and not self._tracked:
                self._body.place(str(self._alignment.remainder))
        self._alignment = head
        if isinstance(last, Text) and inner_following >= 4 > following:
            self._cut_padding(last, elements)

    def _element(self, step: Messages, following: int) -> None:
        self._refusals.append(f"not isinstance({step.variable}, {self._reference(step.type)})")
        self._steps(step.steps, following)
        self._flush()
        self._emit_parts()

    def _settled(self, start: Alignment, step: Messages, following: int) -> Alignment:
        """What is known at the head of the loop: it holds before the first element and behind each."""
        while True:
            trial = Encoder(Constants(""), self._reference)
            trial._needed, trial._in_list, trial._alignment = self._needed, True, start
            trial._element(step, following)
            settled = start.either(trial._alignment)
            if settled == start:
                return start
            start = settled

    def _cut_padding(self, last: Text, elements: str) -> None:
        if not self._tracked:
            self._body.place(str(self._alignment.remainder))
        with self._body.block(f"if {elements}:"):
            self._body.add(f"out[-1] = wire[{last.target}]")
            self._body.move(f"len(out[-1]) - len(padded_wire[{last.target}])")
        self._alignment = Alignment(1, 0)

    def _emit_parts(self) -> None:
        if len(self._parts) == 1:
            part = self._parts[0]
            self._body.add(f"out += {part[1:]}" if part.startswith("*") else f"out.append({part})")
        elif self._parts:
            self._body.add(f"out += ({', '.join(self._parts)})")
        self._parts = []
