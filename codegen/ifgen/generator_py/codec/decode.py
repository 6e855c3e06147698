"""Plan the function that deserialises a message: `_deserialize_Name(data)`.

Its input is `bytes` with the 4-byte header. This path knows little endian only and leaves, by any exception,
as soon as something is not as a healthy peer sends it; `decode_any` then starts over, reads the other byte
order, tolerates what compiled type supports tolerate, and names the field otherwise.

What makes it safe: the position `p` only grows, each fixed run is unpacked by a `struct.Struct` that checks
the length of its buffer, each string reads the byte at its end, a count is compared with what is left before
a loop over it, and whatever was only sliced is checked by one comparison at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import assert_never

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.alignment import HEADER_SIZE, Alignment, RunItem, run_format
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
    fixed_elements,
    smallest_size,
)
from ifgen.generator_py.codec.reads import Reads, tuple_target
from ifgen.generator_py.codec.text import Body, Constants, functions


class Decoder:
    """Plans one deserialising function."""

    def __init__(
        self,
        constants: Constants,
        reference: Callable[[NamespacedType], str],
        heads: dict[tuple[int, Alignment], Alignment] | None = None,
    ) -> None:
        self._constants = constants
        self._runtime = constants.runtime
        self._reference = reference
        # Loops by the identity of their step: without it, each level of nesting would multiply the work.
        self._heads = {} if heads is None else heads

    def plan(
        self, class_name: str, type_: NamespacedType, groups: Sequence[tuple[Step, ...]], *, is_large: bool
    ) -> str:
        """The text of the function; of a large message, after the functions that it calls."""
        body = Body()
        before: list[str] = []
        if is_large:
            arguments = "m, data, view, words, p"
            before += functions(f"_read_{class_name}", arguments, self._in_groups(groups))
        self._in = Reads(self._constants, body, Alignment(8, 0), offset=HEADER_SIZE)
        self._create("m", type_)
        if is_large:
            self._in.flush()
            self._in.uses_words = True
            body.add(f"_read_{class_name}(m, data, view, words, {HEADER_SIZE})")
        else:
            self._all(*groups)
        body.add("return m")
        lines = [f"def _deserialize_{class_name}(data):", "    try:"]
        if self._in.uses_view or self._in.uses_words:
            lines.append("        view = memoryview(data)")
        if self._in.uses_words:
            lines.append('        words = view[: len(data) & -4].cast("I")')
        tail = ["    except Exception:", f"        return {self._runtime('decode_any')}(data, {class_name})"]
        return "\n\n".join([*before, "\n".join([*lines, *body.lines(2), *tail])])

    def _in_groups(self, groups: Sequence[tuple[Step, ...]]) -> Iterator[Body]:
        """Group after group filled in from the position `p` on."""
        alignment = Alignment(1, 0)
        for group in groups:
            body = Body()
            self._in = Reads(self._constants, body, alignment, offset=None)
            self._all(group)
            alignment = self._in.alignment
            body.give("p")
            yield body

    def _all(self, steps: tuple[Step, ...]) -> None:
        self._steps(steps)
        self._in.flush()
        if self._in.unchecked:
            self._in.body.refuse(["p > len(data)"])

    def _create(self, variable: str, type_: NamespacedType) -> None:
        create = self._constants.name(f"{self._runtime('creator')}({self._reference(type_)})")
        self._in.body.add(f"{variable} = {create}()")

    def _steps(self, steps: Sequence[Step]) -> None:
        for step in steps:
            self._step(step)

    def _step(self, step: Step) -> None:
        match step:
            case Nested(target, variable, type_):
                self._create(variable, type_)
                self._in.body.add(f"{target} = {variable}")
            case Placeholder():
                self._in.expect(RunItem("x", 1, 1, None))
            case Scalar(target, "char"):
                character = self._in.name("c")
                self._in.expect(RunItem("B", 1, 1, character))
                self._in.flush()
                self._in.body.add(f"{target} = chr({character})")
            case Scalar(target, type_):
                number = NUMBERS[type_]
                self._in.expect(RunItem(number.format, number.size, number.size, target))
            case Text(wide=True):
                self._wide_text(step)
            case Text():
                self._text(step)
            case Scalars(type=("boolean" | "octet")):
                self._flags(step)
            case Scalars(type="char"):
                self._characters(step)
            case Scalars(target, type_, Count(size=int(size))):
                self._in.expect_array(target, NUMBERS[type_], size)
            case Scalars():
                self._numbers(step)
            case Texts():
                self._texts(step)
            case Messages():
                self._messages(step)
            case Apart():
                self._apart(step)
            case _:
                assert_never(step)

    def _wide_text(self, step: Text) -> None:
        self._in.flush()
        self._in.enter_variable_part()
        self._in.body.add(f"{step.target}, p = {self._runtime('wstring')}(data, p, {step.maximum})")
        self._in.alignment = Alignment(4, 0)

    def _text(self, step: Text) -> None:
        text, body = self._in.name("s"), self._in.body
        if self._in.in_loop and not self._in.has_pending:
            self._in.uses_words = True
            body.add("q = p + 4" if self._in.alignment.is_aligned(4) else "q = p + 7 & -4")
            body.add("p = q + words[(q >> 2) - 1]")
            span = "q : p - 1"
        else:
            size = self._in.name("n")
            self._in.expect(RunItem("I", 4, 4, size))
            self._in.flush()
            if self._in.offset is None:
                span = f"p : (p := p + {size}) - 1"
            else:
                span = f"{self._in.offset} : p - 1"
                body.place(f"{self._in.offset} + {size}")
        body.add(f"{step.target} = {text} = data[{span}].decode()")
        refusals = ["data[p - 1]", f'"\\0" in {text}']
        if step.maximum is not None:
            refusals.append(f"len({text}) > {step.maximum}")
        body.refuse(refusals)
        self._in.offset, self._in.alignment = None, Alignment(1, 0)
        self._in.note_check()

    # Arrays and sequences

    def _count(self, count: Count) -> str:
        """Read the count of a sequence and check its bound; of an array, the size."""
        if count.size is not None:
            self._in.flush()
            return str(count.size)
        name = self._in.name("n")
        self._in.expect(RunItem("I", 4, 4, name))
        self._in.flush()
        if count.maximum is not None:
            self._in.body.refuse([f"{name} > {count.maximum}"])
        return name

    def _texts(self, step: Texts) -> None:
        count = self._count(step.count)
        self._in.enter_variable_part()
        read = self._runtime("wstrings" if step.wide else "strings")
        self._in.body.add(f"{step.target}, p = {read}(data, p, {count}, {step.maximum})")
        self._in.alignment = Alignment(4 if step.wide else 1, 0)

    def _flags(self, step: Scalars) -> None:
        """Booleans and octets are lists."""
        count, size = self._count(step.count), step.count.size
        self._in.enter_variable_part()
        character = NUMBERS[step.type].format
        layout = f'f"{{{count}}}{character}"' if size is None else f'"{count}{character}"'
        self._in.body.add(f"{step.target} = list({self._runtime('unpack_from')}({layout}, data, p))")
        self._in.body.move(count)
        self._in.alignment = Alignment(1, 0) if size is None else self._in.alignment.advanced(size)

    def _characters(self, step: Scalars) -> None:
        """Characters are lists, too."""
        count, size = self._count(step.count), step.count.size
        self._in.enter_variable_part()
        layout = f'f"{{{count}}}s"' if size is None else f'"{count}s"'
        text = f'{self._runtime("unpack_from")}({layout}, data, p)[0].decode("latin-1")'
        self._in.body.add(f"{step.target} = list({text})")
        self._in.body.move(count)
        self._in.alignment = Alignment(1, 0) if size is None else self._in.alignment.advanced(size)

    def _numbers(self, step: Scalars) -> None:
        number = NUMBERS[step.type]
        count = self._count(step.count)
        if number.size == 8:
            self._in.pad_elements(count)
        elements = self._in.name("a")
        self._in.enter_variable_part()
        self._in.body.add(f'{step.target} = {elements} = {self._runtime("array")}("{number.typecode}")')
        self._in.body.add(f"{elements}.frombytes({self._slice(_product(count, number.size))})")
        self._in.alignment = Alignment(min(number.size, 4), 0)

    def _slice(self, size: str) -> str:
        """So many bytes of the input, which may be fewer; `p` moves on."""
        self._in.uses_view = self._in.unchecked = True
        return f"view[p : (p := p + {size})]"

    # Messages in arrays and sequences

    def _messages(self, step: Messages) -> None:
        count = self._count(step.count)
        elements = self._in.name("a")
        fixed = fixed_elements(step.steps)
        if fixed is None:
            self._each_message(step, count, elements)
        else:
            self._unpacked_messages(step, count, elements, *fixed)

    def _unpacked_messages(
        self, step: Messages, count: str, elements: str, items: list[RunItem], alignment: int, size: int
    ) -> None:
        """Elements of one fixed layout, unpacked one after another."""
        if step.count.size is not None:
            self._in.pad(alignment)
        elif alignment == 8:
            self._in.pad_elements(count)
        self._in.enter_variable_part()
        self._in.body.add(f"{step.target} = {elements} = []")
        each = self._constants.layout("each_unpacker", run_format(items, 0)[0])
        with self._in.body.block(f"for values in {each}({self._slice(_product(count, size))}):"):
            self._create(step.variable, step.type)
            self._steps([inner for inner in step.steps if isinstance(inner, Nested)])
            targets = [item.expression for item in items if item.expression is not None]
            if targets:
                self._in.body.add(f"{tuple_target(targets)} = values")
            self._in.body.add(f"{elements}.append({step.variable})")
        if step.count.size is not None:
            self._in.alignment = self._in.alignment.advanced(step.count.size * size)
        else:
            self._in.alignment = Alignment(min(alignment, 4), 0)

    def _each_message(self, step: Messages, count: str, elements: str) -> None:
        """Elements of varying layout, one after another."""
        self._in.enter_variable_part()
        if step.count.size is None:
            needed = _product(count, smallest_size(step.steps))
            self._in.body.refuse([f"{needed} > len(data) - p"])
        self._in.body.add(f"{step.target} = {elements} = []")
        head = self._settled(self._in.alignment, step)
        self._in.alignment = head
        outside, self._in.in_loop = self._in.in_loop, True
        with self._in.body.block(f"for _ in {self._runtime('repeat')}(None, {count}):"):
            self._element(step)
            self._in.body.add(f"{elements}.append({step.variable})")
        self._in.in_loop = outside
        self._in.alignment = head

    def _element(self, step: Messages) -> None:
        self._create(step.variable, step.type)
        self._steps(step.steps)
        self._in.flush()

    def _apart(self, step: Apart) -> None:
        """A message that reads itself."""
        self._in.flush()
        self._in.enter_variable_part()
        self._in.uses_words = True
        read = self._constants.name(f"{self._runtime('reader_of')}({self._reference(step.type)})")
        self._in.body.add(f"p = {read}({step.variable}, data, view, words, p)")
        self._in.alignment = Alignment(1, 0)

    def _settled(self, start: Alignment, step: Messages) -> Alignment:
        """The knowledge at the head of the loop: it holds before the first element and after each."""
        known = id(step), start
        if known not in self._heads:
            trial = Decoder(Constants(""), self._reference, self._heads)
            trial._in = Reads(trial._constants, Body(), start, offset=None)
            trial._in.in_loop = True
            trial._element(step)
            settled = start.either(trial._in.alignment)
            self._heads[known] = start if settled == start else self._settled(settled, step)
        return self._heads[known]


def _product(count: str, size: int) -> str:
    if count.isdigit():
        return str(int(count) * size)
    return count if size == 1 else f"{count} * {size}"
