"""The functions that write and read a message, from the steps of its bytes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from ifgen.model import Field, Item, Message, Primitive, Step, safe_name

ARRAYS: Final[Mapping[str, tuple[str, str]]] = {
    "byte": ("u8", "Uint8"),
    "char": ("u8", "Uint8"),
    "uint8": ("u8", "Uint8"),
    "int8": ("i8", "Int8"),
    "uint16": ("u16", "Uint16"),
    "int16": ("i16", "Int16"),
    "uint32": ("u32", "Uint32"),
    "int32": ("i32", "Int32"),
    "uint64": ("u64", "BigUint64"),
    "int64": ("i64", "BigInt64"),
    "float32": ("f32", "Float32"),
    "float64": ("f64", "Float64"),
}
"""The array of the writer that holds a kind of number, and the word for it in names of JavaScript."""


def key(name: str) -> str:
    """The name of a field in TypeScript."""
    return safe_name(name, "typescript")


@dataclass(frozen=True, slots=True)
class Style:
    """How values look in messages: options of the generator."""

    int64_number: bool = False
    plain_arrays: bool = False

    def is_big(self, primitive: str | None) -> bool:
        """Whether values have to become a bigint, and back."""
        return self.int64_number and primitive in ("int64", "uint64")

    def array(self, primitive: str, elements: str) -> str:
        """An array as messages have it, from a typed one."""
        if self.is_big(primitive):
            return f"globalThis.Array.from({elements}, Number)"
        return f"globalThis.Array.from({elements})" if self.plain_arrays and primitive != "bool" else elements

    def typed(self, primitive: str, array: str) -> str:
        """The array to write, from that in a message."""
        if not self.is_big(primitive):
            return array
        return f"globalThis.Big{'Uint' if primitive == 'uint64' else 'Int'}64Array.from({array}, BigInt)"


@dataclass(slots=True)
class _Lines:
    lines: list[str] = field(default_factory=list[str])
    depth: int = 1
    _numbers: dict[str, int] = field(default_factory=dict[str, int])

    def add(self, *lines: str) -> None:
        self.lines += ["  " * self.depth + line for line in lines]

    def name(self, letter: str) -> str:
        number = self._numbers[letter] = self._numbers.get(letter, 0) + 1
        return f"{letter}{number}"


class WriteFunction:
    """The statements that write a message `m` from position `p`."""

    def __init__(self, style: Style, functions: Mapping[str, str]) -> None:
        self._style = style
        self._functions = functions
        self._out = _Lines()

    def lines(self, steps: Sequence[Step]) -> list[str]:
        """The body of the function."""
        self._steps(steps, "m")
        self._out.add("return p;")
        return self._out.lines

    def _steps(self, steps: Sequence[Step], root: str) -> None:
        names: dict[tuple[str, ...], str] = {(): root}
        for step in steps:
            value = self._value(step.path, names)
            match step.kind:
                case "run":
                    self._run(step, names)
                case "text":
                    self._out.add(self._text(step, value))
                case "call":
                    self._out.add(f"p = {self._functions[f'write {step.type_name}']}(w, {value}, p);")
                case _:
                    self._many(step, value)

    def _value(self, path: tuple[str, ...], names: dict[tuple[str, ...], str]) -> str:
        """The expression for a path; what it goes through gets a name of its own."""
        if path in names:
            return names[path]
        *outer, last = path
        owner = tuple(outer)
        if owner not in names:
            expression = self._value(owner, names)
            names[owner] = self._out.name("m")
            self._out.add(f"const {names[owner]} = {expression};")
        return f"{names[owner]}.{key(last)}"

    def _run(self, step: Step, names: dict[tuple[str, ...], str]) -> None:
        values = [(item, "0" if item.placeholder else self._value(item.path, names)) for item in step.items]
        self._out.add(f"p = w.room(p, {step.align}, {step.size});")
        arrays = dict.fromkeys(_array_of(item)[0] for item in step.items if item.count is None)
        self._out.add("{", *(f"  const {name} = w.{name};" for name in arrays))
        self._out.add(*(f"  w.u8[p + {gap}] = 0;" for gap in _gaps(step)))
        self._out.add(*(f"  {self._item(item, value)}" for item, value in values), "}")
        self._out.add(f"p += {step.size};")

    def _item(self, item: Item, value: str) -> str:
        at = f"p + {item.offset}" if item.offset else "p"
        if item.count is not None:
            array = f"w.{_array_of(item)[0]}s" if item.primitive != "bool" else "w.bools"
            return f"{array}({at}, {self._style.typed(item.primitive, f'cdr.sized({value}, {item.count})')});"
        name = _array_of(item)[0]
        shift = {1: "", 2: " >> 1", 4: " >> 2", 8: " >> 3"}[item.size]
        index = f"({at}){shift}" if shift and item.offset else f"{at}{shift}"
        if not item.placeholder:
            value = self._checked(item.primitive, value)
        return f"{name}[{index}] = {value};"

    def _checked(self, primitive: Primitive, value: str) -> str:
        if self._style.is_big(primitive):
            value = f"BigInt({value})"
        check = {"bool": "bool", "float32": "float", "float64": "float"}.get(primitive) or ARRAYS[primitive][
            0
        ]
        return f"cdr.{check}({value})"

    def _text(self, step: Step, value: str) -> str:
        if step.text_maximum is not None:
            value = f"cdr.bounded({value}, {step.text_maximum})"
        return f"p = w.{'wstring' if step.wide else 'string'}(p, {value});"

    def _many(self, step: Step, value: str) -> None:
        array = self._out.name("a")
        self._out.add(f"const {array} = {value};")
        if step.count is not None:
            number = f"cdr.exactly({array}, {step.count})"
        else:
            number = f"{array}.length" if step.maximum is None else f"cdr.atMost({array}, {step.maximum})"
        if step.kind == "values":
            assert step.primitive is not None
            name = "bools" if step.primitive == "bool" else f"{ARRAYS[step.primitive][0]}s"
            self._out.add(f"p = w.count(p, {number});")
            self._out.add(f"p = w.{name}(p, {self._style.typed(step.primitive, array)});")
            return
        count, index = self._out.name("n"), self._out.name("i")
        self._out.add(f"const {count} = {number};")
        if step.count is None:
            self._out.add(f"p = w.count(p, {count});")
        if step.kind == "repeat" and step.element_align > 1:
            self._out.add(f"if ({count} > 0) p = w.room(p, {step.element_align}, 0);")
        element = f"{array}[{index}]!"
        self._out.add(f"for (let {index} = 0; {index} < {count}; {index}++) {{")
        self._out.depth += 1
        if step.kind == "texts":
            self._out.add(self._text(step, element))
        else:
            name = self._out.name("m")
            self._out.add(f"const {name} = {element};")
            self._steps(step.steps, name)
        self._out.depth -= 1
        self._out.add("}")


def _array_of(item: Item) -> tuple[str, str]:
    return ARRAYS.get(item.primitive, ("u8", "Uint8"))


def _gaps(step: Step) -> Iterator[int]:
    """The offsets of the bytes between the items of a run."""
    end = 0
    for item in step.items:
        yield from range(end, item.offset)
        end = item.offset + item.size * (1 if item.count is None else item.count)


class ReadFunction:
    """The statements that read a message from a reader `r`."""

    def __init__(self, style: Style, functions: Mapping[str, str], types: Mapping[str, Message]) -> None:
        self._style = style
        self._functions = functions
        self._types = types
        self._out = _Lines()

    def lines(self, message: Message, steps: Sequence[Step]) -> list[str]:
        """The body of the function."""
        result = self._message(message, steps)
        if any("v.get" in line for line in (*self._out.lines, result)):
            self._out.lines.insert(0, "  const { view: v, le } = r;")
        self._out.add(f"return {result};")
        return self._out.lines

    def _message(self, message: Message, steps: Sequence[Step]) -> str:
        """Read all steps, and return the literal of the message."""
        values: dict[tuple[str, ...], str] = {}
        for step in steps:
            match step.kind:
                case "run":
                    self._run(step, values)
                case "text":
                    values[step.path] = self._named("s", self._text(step))
                case "call":
                    values[step.path] = self._named("m", f"{self._functions[f'read {step.type_name}']}(r)")
                case "values":
                    values[step.path] = self._values(step)
                case _:
                    values[step.path] = self._many(step)
        return self._literal(message.fields, (), values)

    def _literal(
        self, fields: Sequence[Field], path: tuple[str, ...], values: Mapping[tuple[str, ...], str]
    ) -> str:
        if path in values:  # a call for all of an element
            return values[path]
        parts: list[str] = []
        for each in fields:
            inner = (*path, each.name)
            value = values.get(inner)
            if value is None:
                assert each.type.message is not None
                value = self._literal(self._types[each.type.message.type_name].fields, inner, values)
            parts.append(f"{key(each.name)}: {value}")
        return f"{{ {', '.join(parts)} }}" if parts else "{}"

    def _named(self, letter: str, expression: str) -> str:
        name = self._out.name(letter)
        self._out.add(f"const {name} = {expression};")
        return name

    def _run(self, step: Step, values: dict[tuple[str, ...], str]) -> None:
        start = self._named("o", f"r.take({step.align}, {step.size})")
        for item in step.items:
            at = f"{start} + {item.offset}" if item.offset else start
            if not item.placeholder:
                values[item.path] = self._item(item, at)

    def _item(self, item: Item, at: str) -> str:
        if item.count is not None:
            name = "bools" if item.primitive == "bool" else f"{ARRAYS[item.primitive][0]}s"
            return self._style.array(item.primitive, f"r.{name}({at}, {item.count})")
        if item.primitive == "bool":
            return f"v.getUint8({at}) !== 0"
        word = ARRAYS[item.primitive][1]
        value = f"v.get{word}({at}{', le' if item.size > 1 else ''})"
        return f"Number({value})" if self._style.is_big(item.primitive) else value

    def _text(self, step: Step) -> str:
        bound = "" if step.text_maximum is None else str(step.text_maximum)
        return f"r.{'wstring' if step.wide else 'string'}({bound})"

    def _count(self, step: Step, size: int) -> str:
        most = "" if step.maximum is None else f", {step.maximum}"
        return self._named("n", f"r.count({size}{most})")

    def _values(self, step: Step) -> str:
        assert step.primitive is not None and step.element_size is not None
        count = self._count(step, step.element_size)
        name = "bools" if step.primitive == "bool" else f"{ARRAYS[step.primitive][0]}s"
        size = count if step.element_size == 1 else f"{step.element_size} * {count}"
        align = f"{count} ? {step.element_size} : 1" if step.element_size > 4 else str(step.element_size)
        elements = f"r.{name}(r.take({align}, {size}), {count})"
        return self._named("a", self._style.array(step.primitive, elements))

    def _many(self, step: Step) -> str:
        if step.kind == "texts":
            kind, size = "string", 4
        else:
            assert step.type_name is not None
            kind, size = (
                self._functions[f"type {step.type_name}"],
                self._types[step.type_name].wire.min_element_size,
            )
        count = str(step.count) if step.count is not None else self._count(step, size)
        array, index = self._named("a", f"[] as {kind}[]"), self._out.name("i")
        if step.kind == "repeat" and step.element_align > 1:
            self._out.add(f"if ({count} > 0) r.take({step.element_align}, 0);")
        self._out.add(f"for (let {index} = 0; {index} < {count}; {index}++) {{")
        self._out.depth += 1
        if step.kind == "texts":
            element = self._text(step)
        else:
            element = self._message(self._types[step.type_name or ""], step.steps)
        self._out.add(f"{array}.push({element});")
        self._out.depth -= 1
        self._out.add("}")
        return array
