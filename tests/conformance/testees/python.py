"""Libraries for Python as testees: `python.py ours|rclpy|rosbags|mcap`. IFGEN_CODEC=python tests the codec in Python.

Each reads and writes the fields of its own objects; the walk through a message is the same for all.
"""

from __future__ import annotations

import os
import struct
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from ifgen import resources
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import (
    COLLECTIONS,
    Array,
    BasicType,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedWString,
    ValueType,
    element_of,
)
from ifgen.pipeline.stages import generate, load

INTERFACES: Final = Path(__file__).resolve().parents[1] / "interfaces"
TUNABLES: Final = (
    "glibc.malloc.tcache_count=0:glibc.malloc.perturb=255"  # memory that is not initialised is 0
)
FLOATS: Final = {"float": "f", "double": "d"}
DTYPES: Final = {
    "boolean": "bool",
    "octet": "uint8",
    "char": "uint8",
    "float": "float32",
    "double": "float64",
}


class Skip(Exception):
    """The library does not have this."""


class Refused(Exception):
    """The library refused the input."""


# -- the walk


class Library:
    """A library that reads and writes messages. Its objects have a field of a message as an attribute."""

    name = ""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry

    def definition(self, type_name: str) -> Message:
        """The definition of a message."""
        try:
            return self.registry.message(type_name)
        except KeyError:
            raise Skip("unknown-type") from None

    def new(self, type_name: str) -> Any:
        """A new message."""
        raise Skip("default")

    def empty(self, type_name: str) -> Any:
        """A message whose fields get their values later."""
        return self.new(type_name)

    def decode(self, type_name: str, data: bytes) -> Any:
        """The message in a payload."""
        raise NotImplementedError

    def encode(self, type_name: str, message: Any) -> bytes:
        """The payload of a message."""
        raise NotImplementedError

    def hash(self, type_name: str) -> str:
        """The type hash."""
        raise Skip("hash")

    def constant(self, type_name: str, name: str) -> Any:
        """The value of a constant."""
        raise Skip("constant")

    def value(self, type_: BasicType, number: int | float) -> Any:
        """A number as the library has it in its fields."""
        return number

    def values(self, type_: FieldType, items: list[Any]) -> Any:
        """An array or a sequence as the library has it in its fields."""
        return items

    def dump(self, type_name: str, message: Any, path: str = "") -> Iterator[str]:
        """The leaves of a message."""
        for field in self.definition(type_name).fields:
            value = getattr(message, field.name)
            if not isinstance(field.type, COLLECTIONS):
                yield from self._leaf(path + field.name, field.type, value)
                continue
            if not isinstance(field.type, Array):
                yield f"{path}{field.name}#={len(value)}"
            for index, item in enumerate(value):
                yield from self._leaf(f"{path}{field.name}[{index}]", field.type.value_type, item)

    def _leaf(self, path: str, type_: ValueType, value: Any) -> Iterator[str]:
        if isinstance(type_, NamespacedType):
            yield from self.dump(type_.type_name, value, f"{path}.")
        else:
            yield f"{path}={text_of(type_, value)}"

    def load(self, type_name: str, leaves: Iterator[str]) -> Any:
        """The message that canonical text describes; the paths are not compared."""
        message = self.empty(type_name)
        for field in self.definition(type_name).fields:
            setattr(message, field.name, self._read(field.type, leaves))
        return message

    def _read(self, type_: FieldType, leaves: Iterator[str]) -> Any:
        if isinstance(type_, COLLECTIONS):
            count = type_.size if isinstance(type_, Array) else int(next(leaves))
            return self.values(type_, [self._read(type_.value_type, leaves) for _ in range(count)])
        if isinstance(type_, NamespacedType):
            return self.load(type_.type_name, leaves)
        text = next(leaves)
        if not isinstance(type_, BasicType):
            wide = isinstance(type_, UnboundedWString | BoundedWString)
            return bytes.fromhex(text).decode("utf-16-be" if wide else "utf-8")
        if type_.typename in FLOATS:
            return self.value(type_, struct.unpack(f">{FLOATS[type_.typename]}", bytes.fromhex(text))[0])
        return self.value(type_, bool(int(text)) if type_.typename == "boolean" else int(text))


def text_of(type_: ValueType, value: Any) -> str:
    """A leaf's value as canonical text."""
    if isinstance(type_, BasicType):
        if type_.typename in FLOATS:
            return struct.pack(f">{FLOATS[type_.typename]}", value).hex()
        return str(ord(value) if isinstance(value, str | bytes) else int(value))
    wide = isinstance(type_, UnboundedWString | BoundedWString)
    encoded: bytes = value.encode("utf-16-be" if wide else "utf-8")
    return encoded.hex()


# -- the libraries


class Classes(Library):
    """Message classes in the manner of rosidl."""

    errors: tuple[type[Exception], ...] = ()

    def cls(self, type_name: str) -> type[Any]:
        """The class of a type."""
        from ifgen_runtime.field_types import message_class

        package, folder, name = type_name.split("/")
        action, _, part = name.rpartition("_")
        part = {"SendGoal": "SendGoalService", "GetResult": "GetResultService"}.get(part, part)
        try:
            if part in ("FeedbackMessage", "SendGoalService", "GetResultService"):
                inner: type[Any] = getattr(message_class(f"{package}.{folder}", action).Impl, part)
                return inner
            return message_class(f"{package}.{folder}", name)
        except (ImportError, AttributeError):
            raise Skip("unknown-type") from None

    def new(self, type_name: str) -> Any:
        return self.cls(type_name)()

    def constant(self, type_name: str, name: str) -> Any:
        return getattr(self.cls(type_name), name)

    def value(self, type_: BasicType, number: int | float) -> Any:
        if type_.typename == "octet":
            return bytes([int(number)])
        return chr(int(number)) if type_.typename == "char" else number


class Ours(Classes):
    """The classes that ifgen generates, with either codec."""

    def __init__(self, registry: Registry) -> None:
        super().__init__(registry)
        folder = tempfile.mkdtemp()
        generate(INTERFACES, output=folder)
        sys.path[:0] = [folder, str(resources.bundled_generated())]
        import ifgen_runtime
        from ifgen_runtime.codec.choice import chosen

        self.errors = (ifgen_runtime.SerializationError, ifgen_runtime.DeserializationError)
        self.name = f"ifgen-{chosen().name}"
        self.serialize: Callable[[Any], bytes] = ifgen_runtime.serialize
        self.deserialize: Callable[[bytes, type[Any]], Any] = ifgen_runtime.deserialize

    def decode(self, type_name: str, data: bytes) -> Any:
        return self.deserialize(data, self.cls(type_name))

    def encode(self, type_name: str, message: Any) -> bytes:
        return self.serialize(message)

    def hash(self, type_name: str) -> str:
        cls: Any = self.cls(type_name)
        return str(cls.__type_hash__)


class Rclpy(Classes):
    """What the installed rclpy does, padding included, which it leaves as it was in memory."""

    name = "rclpy"
    errors = (Exception,)

    def __init__(self, registry: Registry) -> None:
        super().__init__(registry)
        from rclpy.serialization import deserialize_message, serialize_message

        self.deserialize, self.serialize = deserialize_message, serialize_message

    def decode(self, type_name: str, data: bytes) -> Any:
        return self.deserialize(data, self.cls(type_name))

    def encode(self, type_name: str, message: Any) -> bytes:
        data = bytes(self.serialize(message))
        # It returns the size that it estimated. What it wrote ends where reading the message ends.
        return data[: size_of(self, type_name, message)]


def size_of(library: Library, type_name: str, message: Any, at: int = 4) -> int:
    """Where a message ends that begins at this place."""

    def value(at: int, type_: ValueType, item: Any) -> int:
        if isinstance(type_, NamespacedType):
            return size_of(library, type_.type_name, item, at)
        if isinstance(type_, BasicType):
            digits = type_.typename.lstrip("uint")
            size = {"float": 4, "double": 8}.get(type_.typename) or (
                int(digits) // 8 if digits.isdigit() else 1
            )
            return at + (4 - at) % size + size
        at += -at % 4 + 4
        wide = isinstance(type_, UnboundedWString | BoundedWString)
        return at + (2 * len(item.encode("utf-16-le")) if wide else len(item.encode()) + 1)

    fields = library.definition(type_name).fields
    for field in fields:
        item = getattr(message, field.name)
        if isinstance(field.type, COLLECTIONS):
            at += 0 if isinstance(field.type, Array) else -at % 4 + 4
            for each in item:
                at = value(at, field.type.value_type, each)
        else:
            at = value(at, field.type, item)
    return at if fields else at + 1


class Rosbags(Library):
    """rosbags, with the definitions of messages of the suite."""

    name = "rosbags"
    errors = (Exception,)

    def __init__(self, registry: Registry) -> None:
        super().__init__(registry)
        from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore

        self.store = get_typestore(Stores.EMPTY)
        for type_name, text in definitions(registry):
            try:
                self.store.register(get_types_from_msg(text, type_name))
            except TypesysError:
                continue  # a form that it does not know; the types that need it fail when they are used

    def definition(self, type_name: str) -> Message:
        if type_name not in self.store.types:
            raise Skip("unknown-type")
        return super().definition(type_name)

    def empty(self, type_name: str) -> Any:
        return object.__new__(self.store.types[type_name])

    def load(self, type_name: str, leaves: Iterator[str]) -> Any:
        fields = self.definition(type_name).fields
        values = {field.name: self._read(field.type, leaves) for field in fields}
        return self.store.types[type_name](**(values or {"structure_needs_at_least_one_member": 0}))

    def values(self, type_: FieldType, items: list[Any]) -> Any:
        import numpy

        element = element_of(type_)
        if not isinstance(element, BasicType):
            return items
        return numpy.array(items, DTYPES.get(element.typename, element.typename))

    def decode(self, type_name: str, data: bytes) -> Any:
        self.definition(type_name)
        return self.store.deserialize_cdr(data, type_name)

    def encode(self, type_name: str, message: Any) -> bytes:
        return bytes(self.store.serialize_cdr(message, type_name))

    def hash(self, type_name: str) -> str:
        self.definition(type_name)
        return self.store.hash_rihs01(type_name)

    def constant(self, type_name: str, name: str) -> Any:
        self.definition(type_name)
        return getattr(self.store.types[type_name], name)


class Mcap(Library):
    """mcap-ros2-support, which reads with definitions and writes what it read."""

    name = "mcap-ros2-support"
    errors = (Exception,)

    def __init__(self, registry: Registry) -> None:
        super().__init__(registry)
        self.texts = dict(definitions(registry))
        self.functions: dict[str, tuple[Any, Any]] = {}

    def _functions(self, type_name: str) -> tuple[Any, Any]:
        from mcap_ros2._dynamic import generate_dynamic, serialize_dynamic

        if type_name not in self.texts:
            raise Skip("unknown-type")
        if type_name not in self.functions:
            parts, needed = [self.texts[type_name]], [type_name]
            for name in needed:
                for field in self.registry.message(name).fields:
                    element = element_of(field.type)
                    if isinstance(element, NamespacedType) and element.type_name not in needed:
                        needed.append(element.type_name)
                        short = f"{element.package}/{element.name}"
                        parts.append(f"{'=' * 80}\nMSG: {short}\n{self.texts[element.type_name]}")
            schema = "\n".join(parts)
            self.functions[type_name] = (
                generate_dynamic(type_name, schema)[type_name],
                serialize_dynamic(type_name, schema)[type_name],
            )
        return self.functions[type_name]

    def empty(self, type_name: str) -> Any:
        raise Skip("load")

    def decode(self, type_name: str, data: bytes) -> Any:
        return self._functions(type_name)[0](data)

    def encode(self, type_name: str, message: Any) -> bytes:
        return bytes(self._functions(type_name)[1](message))


def definitions(registry: Registry) -> Iterator[tuple[str, str]]:
    """The names and texts of the messages that have files of their own."""
    for interface in registry:
        if isinstance(interface, Message) and interface.source is not None and interface.folder == "msg":
            yield interface.type_name, interface.source.text


# -- the protocol


def answer(library: Library, op: str, type_name: str, rest: str) -> str:
    """The data of the reply to a request."""
    words = rest.split(" ")

    def decoded(index: int = 0) -> Any:
        return library.decode(type_name, bytes.fromhex("" if words[index] == "-" else words[index]))

    def encoded(message: Any) -> str:
        return library.encode(type_name, message).hex()

    match op:
        case "hello":
            return f"protocol=1 language=python library={library.name}"
        case "hash":
            return library.hash(type_name)
        case "default":
            return encoded(library.new(type_name))
        case "constant":
            [constant] = [item for item in library.definition(type_name).constants if item.name == words[0]]
            return text_of(constant.type, library.constant(type_name, words[0]))
        case "recode":
            return encoded(decoded())
        case "dump":
            return " ".join(library.dump(type_name, decoded()))
        case "load":
            leaves = (word.partition("=")[2] for word in rest.split(" ") if word)
            return encoded(library.load(type_name, leaves))
        case "equal":
            return str(int(bool(decoded(0) == decoded(1))))
        case "bench":
            return bench(library, type_name, bytes.fromhex(words[0]), int(words[1]))
        case _:
            raise Skip(op)


def bench(library: Library, type_name: str, data: bytes, count: int) -> str:
    """Nanoseconds for encoding and decoding."""
    message = library.decode(type_name, data)
    begin = time.process_time_ns()
    for _ in range(count):
        library.encode(type_name, message)
    middle = time.process_time_ns()
    for _ in range(count):
        library.decode(type_name, data)
    end = time.process_time_ns()
    return f"{(middle - begin) / count:.1f} {(end - middle) / count:.1f}"


def reply(library: Library, line: str) -> str:
    """The reply to a request."""
    op, id_, type_name, *rest = line.split(" ", 3)
    try:
        return f"ok {id_} {answer(library, op, type_name, rest[0] if rest else '')}"
    except Skip as error:
        return f"skip {id_} {error}"
    except Exception as error:
        refused = isinstance(error, getattr(library, "errors", ()))
        words = f"{type(error).__name__}: {error}".encode("ascii", "replace").decode().replace("\n", " ")
        return f"{'refused' if refused else 'fail'} {id_} {words[:300]}"


LIBRARIES: Final = {"ours": Ours, "rclpy": Rclpy, "rosbags": Rosbags, "mcap": Mcap}


def main() -> None:
    """Answer until the input ends. What a library prints goes to stderr."""
    if sys.argv[1] == "rclpy" and os.environ.get("GLIBC_TUNABLES") != TUNABLES:
        os.environ["GLIBC_TUNABLES"] = TUNABLES
        os.execv(sys.executable, [sys.executable, *sys.argv])
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    library = LIBRARIES[sys.argv[1]](load(resources.bundled_interfaces(), INTERFACES))
    for line in sys.stdin:
        print(reply(library, line.rstrip("\n")), file=output, flush=True)


if __name__ == "__main__":
    main()
