"""Plan the function that deserialises a message: `_deserialize_Name(data) -> Name`.

Its input is `bytes` with the 4-byte header. This path knows little endian only and leaves, by any exception,
as soon as something is not as a healthy peer sends it; `decode_any` then starts over, reads the other byte
order, tolerates what compiled type supports tolerate, and names the field otherwise.

What makes it safe: the position `p` only grows, each fixed run is unpacked by a `struct.Struct` that checks
the length of its buffer, each string reads the byte at its end, a count is compared with what is left before
a loop over it, and whatever was only sliced is checked by one comparison at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.layout import (
    HEADER_SIZE,
    NUMBERS,
    Alignment,
    Count,
    Messages,
    Nested,
    Number,
    Placeholder,
    RunItem,
    Scalar,
    Scalars,
    Step,
    Text,
    Texts,
    after_run,
    fixed_elements,
    run_format,
    smallest_size,
)
from ifgen.generator_py.codec.text import Body, Constants

_LARGE_REGION = 1024


class Decoder:
    """Plans one deserialising function."""

    def __init__(self, constants: Constants, reference: Callable[[NamespacedType], str]) -> None:
        self._constants = constants
        self._reference = reference
        self._body = Body()
        self._run: list[RunItem] = []
        self._arrays: list[tuple[int, str, Number, int]] = []
        self._alignment = Alignment(8, 0)
        self._offset: int | None = HEADER_SIZE
        self._header_read = False
        self._unchecked = False
        self._in_loop = False
        self._uses_view = False
        self._uses_words = False
        self._names = 0

    def plan(self, class_name: str, type_: NamespacedType, steps: tuple[Step, ...]) -> str:
        """The text of the function."""
        self._create("m", type_)
        self._steps(steps)
        self._flush()
        if self._unchecked:
            self._body.refuse(["p > len(data)"])
        self._body.add("return m")
        lines = [f"def _deserialize_{class_name}(data):", "    try:"]
        if self._uses_view or self._uses_words:
            lines.append("        view = memoryview(data)")
        if self._uses_words:
            lines.append('        words = view[: len(data) & -4].cast("I")')
        lines.extend(self._body.lines(2))
        lines += ["    except Exception:", f"        return decode_any(data, {class_name})"]
        return "\n".join(lines)

    def _name(self, prefix: str) -> str:
        self._names += 1
        return f"{prefix}{self._names}"

    def _create(self, variable: str, type_: NamespacedType) -> None:
        create = self._constants.name(f"creator({self._reference(type_)})")
        self._body.add(f"{variable} = {create}()")

    # The position: a number as long as it is known, the variable `p` from then on

    def _enter_variable_part(self) -> None:
        if self._offset is not None:
            self._body.place(str(self._offset))
            self._offset = None

    def _pad(self, alignment: int) -> None:
        """Move `p` to the alignment."""
        self._enter_variable_part()
        if self._alignment.modulus >= alignment:
            padding = -self._alignment.remainder % alignment
            if padding:
                self._body.move(str(padding))
        else:
            self._body.place(_aligned(alignment))
        self._alignment = self._alignment.aligned(alignment)

    def _pad_elements(self, count: str) -> None:
        """Move `p` from the count of a sequence to its 8-byte elements; an empty one is not padded."""
        self._enter_variable_part()
        if self._alignment.is_aligned(8):
            return
        with self._body.block(f"if {count}:"):
            self._body.place(_aligned(8))
        self._alignment = Alignment(4, 0)

    # Runs of fixed layout

    def _expect(self, item: RunItem) -> None:
        """Add an item to the run, or begin a new one where the padding before it is not known."""
        if self._run and item.alignment > after_run(self._run, self._alignment).modulus:
            self._flush()
        self._run.append(item)

    def _flush(self) -> None:
        """Unpack the pending run at once."""
        if self._header_read and not self._run:
            return
        if self._run and self._offset is None and self._run[0].alignment > self._alignment.modulus:
            self._pad(self._run[0].alignment)
        text, size = run_format(self._run, self._alignment.remainder)
        targets = [item.expression for item in self._run if item.expression is not None]
        where = "p" if self._offset is None else str(self._offset)
        if not self._header_read:
            text, where = "H2x" + text, "0"
            targets.insert(0, "encoding")
        unpack = f"{self._constants.layout('unpacker', text)}(data, {where})"
        self._body.add(f"{_tuple_target(targets)} = {unpack}" if targets else unpack)
        if not self._header_read:
            self._body.refuse(["encoding != 256"])  # 00 01: plain CDR, little endian
            self._header_read = True
        self._emit_arrays()
        self._alignment = after_run(self._run, self._alignment)
        if self._offset is None:
            self._body.move(str(size))
        else:
            self._offset += size
        self._run, self._arrays = [], []
        if not self._in_loop:
            self._unchecked = False

    def _emit_arrays(self) -> None:
        """Give the numpy arrays of the run one writable copy of the bytes that they are in."""
        if not self._arrays:
            return
        start = self._alignment.remainder
        starts = [
            run_format([*self._run[:index], RunItem("", self._run[index].alignment, 0, None)], start)[1]
            for index, *_ in self._arrays
        ]
        _, _, number, count = self._arrays[-1]
        region = starts[0], starts[-1] + number.size * count
        source = "data"
        if region[1] - region[0] > _LARGE_REGION:
            source, self._uses_view = "view", True
        begin, end = (self._shifted(offset) for offset in region)
        block = self._name("block")
        self._body.add(f"{block} = bytearray({source}[{begin}:{end}])")
        for (_, target, number, count), offset in zip(self._arrays, starts, strict=True):
            arguments = f"({count},), numeric.{number.dtype}, {block}, {offset - starts[0]}"
            self._body.add(f"{target} = numeric.ndarray({arguments})")

    def _shifted(self, offset: int) -> str:
        if self._offset is not None:
            return str(self._offset + offset)
        return f"p + {offset}" if offset else "p"

    # Steps

    def _steps(self, steps: Sequence[Step]) -> None:
        for step in steps:
            self._step(step)

    def _step(self, step: Step) -> None:
        match step:
            case Nested(target, variable, type_):
                self._create(variable, type_)
                self._body.add(f"{target} = {variable}")
            case Placeholder():
                self._expect(RunItem("x", 1, 1, None))
            case Scalar(target, type_):
                number = NUMBERS[type_]
                self._expect(RunItem(number.format, number.size, number.size, target))
            case Text():
                self._text(step)
            case Scalars(type=("boolean" | "octet")):
                self._flags(step)
            case Scalars(count=Count(size=int(size))):
                self._fixed_numbers(step, size)
            case Scalars():
                self._numbers(step)
            case Texts():
                self._texts(step)
            case Messages():
                self._messages(step)
            case _:
                assert_never(step)

    def _count(self, count: Count) -> str:
        """Read the count of a sequence and check its bound; of an array, the size."""
        if count.size is not None:
            self._flush()
            return str(count.size)
        name = self._name("n")
        self._expect(RunItem("I", 4, 4, name))
        self._flush()
        if count.maximum is not None:
            self._body.refuse([f"{name} > {count.maximum}"])
        return name

    def _text(self, step: Text) -> None:
        if step.wide:
            self._flush()
            self._enter_variable_part()
            self._body.add(f"{step.target}, p = wstring(data, p, {step.maximum})")
            self._alignment = Alignment(4, 0)
            return
        text = self._name("s")
        if self._in_loop and not self._run:
            self._uses_words = True
            self._body.add("q = p + 7 & -4" if not self._alignment.is_aligned(4) else "q = p + 4")
            self._body.add("p = q + words[(q >> 2) - 1]")
            span = "q : p - 1"
        else:
            length = self._name("n")
            self._expect(RunItem("I", 4, 4, length))
            self._flush()
            if self._offset is None:
                span = f"p : (p := p + {length}) - 1"
            else:
                span = f"{self._offset} : p - 1"
                self._body.place(f"{self._offset} + {length}")
        self._body.add(f"{step.target} = {text} = data[{span}].decode()")
        refusals = ["data[p - 1]", f'"\\0" in {text}']
        if step.maximum is not None:
            refusals.append(f"len({text}) > {step.maximum}")
        self._body.refuse(refusals)
        self._offset, self._alignment = None, Alignment(1, 0)
        if not self._in_loop:
            self._unchecked = False

    def _texts(self, step: Texts) -> None:
        count = self._count(step.count)
        self._enter_variable_part()
        if step.wide:
            self._body.add(f"{step.target}, p = wstrings(data, p, {count}, {step.maximum})")
        else:
            self._uses_words = True
            self._body.add(f"{step.target}, p = strings(data, words, p, {count}, {step.maximum})")
        self._alignment = Alignment(4 if step.wide else 1, 0)

    def _flags(self, step: Scalars) -> None:
        """Booleans and octets are lists."""
        count = self._count(step.count)
        self._enter_variable_part()
        character = NUMBERS[step.type].format
        layout = f'"{count}{character}"' if count.isdigit() else f'f"{{{count}}}{character}"'
        self._body.add(f"{step.target} = list(unpack_from({layout}, data, p))")
        self._body.move(count)
        self._alignment = self._alignment.advanced(step.count.size) if step.count.size else Alignment(1, 0)

    def _fixed_numbers(self, step: Scalars, size: int) -> None:
        number = NUMBERS[step.type]
        total = size * number.size
        self._expect(RunItem(f"{total}x", number.size, total, None))
        self._arrays.append((len(self._run) - 1, step.target, number, size))

    def _numbers(self, step: Scalars) -> None:
        number = NUMBERS[step.type]
        count = self._count(step.count)
        if number.size == 8:
            self._pad_elements(count)
        self._enter_variable_part()
        self._uses_view = self._unchecked = True
        elements = self._name("a")
        self._body.add(f'{step.target} = {elements} = array("{number.typecode}")')
        self._body.add(f"{elements}.frombytes(view[p : (p := p + {_product(count, number.size)})])")
        self._alignment = Alignment(min(number.size, 4), 0)

    # Messages in arrays and sequences

    def _messages(self, step: Messages) -> None:
        count = self._count(step.count)
        elements = self._name("a")
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
            self._pad(alignment)
        elif alignment == 8:
            self._pad_elements(count)
        self._enter_variable_part()
        self._uses_view = self._unchecked = True
        self._body.add(f"{step.target} = {elements} = []")
        each = self._constants.layout("each_unpacker", run_format(items, 0)[0])
        source = f"view[p : (p := p + {_product(count, size)})]"
        with self._body.block(f"for values in {each}({source}):"):
            self._create(step.variable, step.type)
            for inner in step.steps:
                if isinstance(inner, Nested):
                    self._create(inner.variable, inner.type)
                    self._body.add(f"{inner.target} = {inner.variable}")
            targets = [item.expression for item in items if item.expression is not None]
            if targets:
                self._body.add(f"{_tuple_target(targets)} = values")
            self._body.add(f"{elements}.append({step.variable})")
        if step.count.size is not None:
            self._alignment = self._alignment.advanced(step.count.size * size)
        else:
            self._alignment = Alignment(min(alignment, 4), 0)

    def _each_message(self, step: Messages, count: str, elements: str) -> None:
        """Elements of varying layout, one after another."""
        self._enter_variable_part()
        if step.count.size is None:
            self._body.refuse([f"{_product(count, smallest_size(step.steps))} > len(data) - p"])
        self._body.add(f"{step.target} = {elements} = []")
        head = self._settled(self._alignment, step)
        self._alignment = head
        outside, self._in_loop = self._in_loop, True
        with self._body.block(f"for _ in repeat(None, {count}):"):
            self._element(step)
            self._body.add(f"{elements}.append({step.variable})")
        self._in_loop = outside
        self._alignment = head

    def _element(self, step: Messages) -> None:
        self._create(step.variable, step.type)
        self._steps(step.steps)
        self._flush()

    def _settled(self, start: Alignment, step: Messages) -> Alignment:
        """What is known at the head of the loop: it holds before the first element and behind each."""
        while True:
            trial = Decoder(Constants(""), self._reference)
            trial._header_read, trial._in_loop = True, True
            trial._offset, trial._alignment = None, start
            trial._element(step)
            settled = start.either(trial._alignment)
            if settled == start:
                return start
            start = settled


def _aligned(alignment: int) -> str:
    """The next position of this alignment; that of 8 bytes is counted from behind the header."""
    return "(p + 3 & -8) + 4" if alignment == 8 else f"p + {alignment - 1} & -{alignment}"


def _product(count: str, size: int) -> str:
    if count.isdigit():
        return str(int(count) * size)
    return count if size == 1 else f"{count} * {size}"


def _tuple_target(targets: Sequence[str]) -> str:
    return f"({targets[0]},)" if len(targets) == 1 else f"({', '.join(targets)})"
