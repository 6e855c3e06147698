"""The functions that size, write and read a message, from the steps of its bytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from ifgen.model import Field, Item, Message, Step, safe_name

TYPES: Final[Mapping[str, str]] = {
    **{"bool": "bool", "byte": "u8", "char": "u8", "float32": "f32", "float64": "f64"},
    **{f"{sign}int{bits}": f"{'u' if sign else 'i'}{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
MOST: Final = "usize::MAX"


def key(name: str) -> str:
    """The name of a field in Rust."""
    return safe_name(name, "rust")


def borrows(message: Message, types: Mapping[str, Message]) -> bool:
    """Whether there is something in a message that a view of it can borrow."""
    return any(
        borrows(types[each.type.message.type_name], types)
        if each.type.message
        else each.type.primitive == "string"
        or (each.type.primitive in TYPES and each.type.array is not None and each.type.array.kind != "fixed")
        for each in message.fields
    )


class Codec:
    """The bodies of the functions of one message. `root` is the module with all packages."""

    def __init__(self, message: Message, types: Mapping[str, Message], root: str) -> None:
        self._message = message
        self._types = types
        self._root = root
        self._number = 0
        self._lines: list[str] = []
        self._depth = 2
        self._borrowed = False
        self._outer: tuple[str, ...] = (message.name,)

    def path_of(self, type_name: str, borrowed: bool = False) -> str:
        """The path of a message's struct, or of its view."""
        package, folder, name = type_name.split("/")
        view = "View" if borrowed and borrows(self._types[type_name], self._types) else ""
        return f"{self._root}::{package}::{folder}::{name}{view}"

    def _add(self, line: str) -> None:
        self._lines.append("    " * self._depth + line)

    def _name(self, letter: str) -> str:
        self._number += 1
        return f"{letter}{self._number}"

    def _body(self, fill: Callable[[], None]) -> list[str]:
        self._number, self._lines = 0, []
        fill()
        return self._lines

    def _field(self, step: Step) -> str:
        """The path of a field in errors."""
        return f'"{".".join((*self._outer, *step.path))}"'

    # -- sizes

    def end(self, steps: Sequence[Step]) -> list[str]:
        """The body of `end`."""

        def fill() -> None:
            self._end(steps, "self")
            self._add("p")

        return self._body(fill)

    def _end(self, steps: Sequence[Step], root: str) -> None:
        for step in steps:
            value = _value(root, step.path)
            if step.kind == "run":
                aligned = f"cdr::align(p, {step.align})" if step.align > 1 else "p"
                self._add(f"p = {aligned} + {step.size};")
            elif step.kind == "text":
                self._add(f"p = cdr::end_of_{'wstring' if step.wide else 'string'}(p, &{value});")
            elif step.kind == "call":
                self._add(f"p = {value}.end_part(p);")
            else:
                if step.count is None:
                    self._add("p = cdr::align(p, 4) + 4;")
                if step.kind == "values":
                    self._add(f"p = cdr::end_of_numbers(p, &{value});")
                elif step.kind == "repeat" and step.stride is not None:
                    start = f"cdr::align(p, {step.element_align})"
                    self._add(f"if !{value}.is_empty() {{ p = {start} + {step.stride} * {value}.len(); }}")
                else:
                    self._loop(step, value, self._end, self._end_of_text)

    def _end_of_text(self, step: Step, element: str) -> None:
        self._add(f"p = cdr::end_of_{'wstring' if step.wide else 'string'}(p, {element});")

    def _loop(
        self,
        step: Step,
        value: str,
        inner: Callable[[Sequence[Step], str], None],
        text: Callable[[Step, str], None],
    ) -> None:
        element = self._name("e")
        self._add(f"for {element} in &{value} {{")
        self._depth += 1
        if step.kind == "texts":
            text(step, element)
        else:
            outer = self._outer
            self._outer = (*outer, f"{'.'.join(step.path)}[]")
            inner(step.steps, element)
            self._outer = outer
        self._depth -= 1
        self._add("}")

    # -- writing

    def write(self, steps: Sequence[Step]) -> list[str]:
        """The body of `write`."""

        def fill() -> None:
            self._write(steps, "self")
            self._add("Ok(())")

        return self._body(fill)

    def _write(self, steps: Sequence[Step], root: str) -> None:
        for step in steps:
            value = _value(root, step.path)
            match step.kind:
                case "run":
                    self._write_run(step, root)
                case "text":
                    self._write_text(step, f"&{value}")
                case "call":
                    self._add(f"{value}.write_part(w)?;")
                case _:
                    self._write_many(step, value)

    def _write_run(self, step: Step, root: str) -> None:
        if len(step.items) == 1 and step.items[0].count is not None:
            self._add(f"w.numbers(&{_value(root, step.items[0].path)});")
            return
        run = self._name("b")
        self._add(f"let mut {run} = [0u8; {step.size}];")
        for item in step.items:
            if item.placeholder:
                continue
            end = item.offset + item.size * (1 if item.count is None else item.count)
            place, value = f"&mut {run}[{item.offset}..{end}]", _value(root, item.path)
            store = f"cdr::store({place}, &{value});" if item.count is not None else f"{value}.put({place});"
            self._add(store)
        self._add(f"w.bytes({step.align}, &{run});")

    def _write_text(self, step: Step, value: str) -> None:
        most = MOST if step.text_maximum is None else step.text_maximum
        self._add(f"w.{'wstring' if step.wide else 'string'}({value}, {most}, {self._field(step)})?;")

    def _write_many(self, step: Step, value: str) -> None:
        if step.count is None:
            most = "u32::MAX as usize" if step.maximum is None else step.maximum
            self._add(f"w.count({value}.len(), {most}, {self._field(step)})?;")
        if step.kind == "values":
            self._add(f"w.numbers(&{value});")
            return
        if step.kind == "repeat" and step.element_align > 1:
            self._add(f"if !{value}.is_empty() {{ w.align({step.element_align}); }}")
        self._loop(step, value, self._write, self._write_text)

    # -- reading

    def read(self, steps: Sequence[Step], borrowed: bool = False) -> list[str]:
        """The body of `read`, of the message or of its view."""
        self._borrowed = borrowed

        def fill() -> None:
            literal = self._read(self._message, steps)
            self._add(f"Ok({literal})")

        return self._body(fill)

    def _read(self, message: Message, steps: Sequence[Step]) -> str:
        values: dict[tuple[str, ...], str] = {}
        for step in steps:
            if step.kind == "run":
                self._read_run(step, values)
                continue
            name = values[step.path] = self._name("v")
            match step.kind:
                case "text":
                    expression = f"{self._read_text(step)}?"
                case "call":
                    expression = f"{self.path_of(step.type_name or '', self._borrowed)}::read_part(r)?"
                case "values":
                    most = MOST if step.maximum is None else step.maximum
                    kind = TYPES[step.primitive or ""]
                    copy = "" if self._borrowed else ".to_vec()"
                    expression = f"r.numbers::<{kind}>({most}, {self._field(step)})?{copy}"
                case _:
                    self._read_many(step, name)
                    continue
            self._add(f"let {name} = {expression};")
        return self._literal(message, (), values)

    def _literal(self, message: Message, path: tuple[str, ...], values: Mapping[tuple[str, ...], str]) -> str:
        if path in values:  # a call for all of an element
            return values[path]
        parts: list[str] = []
        for each in message.fields:
            inner = (*path, each.name)
            value = values.get(inner)
            if value is None:
                value = self._literal(self._nested(each), inner, values)
            parts.append(f"{key(each.name)}: {value}")
        return f"{self.path_of(message.type_name, self._borrowed)} {{ {', '.join(parts)} }}"

    def _nested(self, field: Field) -> Message:
        assert field.type.message is not None
        return self._types[field.type.message.type_name]

    def _read_run(self, step: Step, values: dict[tuple[str, ...], str]) -> None:
        run = self._name("b")
        self._add(f"let {run} = r.run::<{step.size}>({step.align})?;")
        for item in step.items:
            if not item.placeholder:
                values[item.path] = self._item(item, run)

    def _item(self, item: Item, run: str) -> str:
        kind = TYPES[item.primitive]
        if item.count is not None:
            return f"r.array::<{kind}, {item.count}, _>({run}, {item.offset})"
        return f"r.value::<{kind}, _>({run}, {item.offset})"

    def _read_text(self, step: Step) -> str:
        most = MOST if step.text_maximum is None else step.text_maximum
        name = "wstring" if step.wide else "str" if self._borrowed else "string"
        return f"r.{name}({most}, {self._field(step)})"

    def _read_many(self, step: Step, name: str) -> None:
        element_type = self._types.get(step.type_name or "")  # None for strings, which have a length at least
        size = element_type.wire.min_element_size if element_type else 4
        align = f"r.take({step.element_align}, 0)?;"
        if step.count is not None:
            if step.kind == "repeat" and step.element_align > 1:
                self._add(align)
            self._add(f"let {name} = r.each(|r| {{")
        else:
            count = self._name("n")
            most = MOST if step.maximum is None else step.maximum
            self._add(f"let {count} = r.count({size}, {most}, {self._field(step)})?;")
            if step.kind == "repeat" and step.element_align > 1:
                self._add(f"if {count} > 0 {{ {align} }}")
            self._add(f"let mut {name} = ::std::vec::Vec::with_capacity({count});")
            self._add(f"for _ in 0..{count} {{")
        self._depth += 1
        if step.kind == "texts":
            element = f"{self._read_text(step)}?"
        else:
            outer = self._outer
            self._outer = (*outer, f"{'.'.join(step.path)}[]")
            element = self._read(self._types[step.type_name or ""], step.steps)
            self._outer = outer
        self._add(f"Ok({element})" if step.count is not None else f"{name}.push({element});")
        self._depth -= 1
        self._add("})?;" if step.count is not None else "}")


def _value(root: str, path: Sequence[str]) -> str:
    return ".".join([root, *map(key, path)])
