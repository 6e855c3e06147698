"""Serialise and deserialise messages, and what the generated codecs are made of.

`serialize` and `deserialize` are for everybody; the other names are for generated modules. Message packages
import this module, so it must load in a millisecond: whatever is rare is imported where it is needed.
"""

from __future__ import annotations

from array import array
from itertools import repeat
from struct import Struct, unpack_from
from sys import byteorder

from ifgen_runtime.codec.texts import (
    any_longer,
    padded_strings_wire,
    padded_wire,
    strings,
    strings_wire,
    wire,
    wstring,
    wstring_wire,
    wstrings,
    wstrings_wire,
)
from ifgen_runtime.lazy import LazyModule, numeric

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable
    from functools import partial
    from typing import Any, Literal, TypeAlias, TypeVar, overload

    from ifgen_runtime import views as viewing
    from ifgen_runtime.interface import HasViews

    Buffer: TypeAlias = bytes | bytearray | memoryview | array[Any]
    ViewsT = TypeVar("ViewsT")
    MessageT = TypeVar("MessageT")
    Write: TypeAlias = Callable[[Any, list[Any], int], int]
    Read: TypeAlias = Callable[[Any, bytes, memoryview, memoryview, int], int]
else:
    from _functools import partial  # functools itself takes as long to import as two message classes

    viewing = LazyModule("ifgen_runtime.views")


__all__ = [
    "any_longer",
    "around_text",
    "array",
    "attach_codec",
    "attach_parts",
    "booleans_wire",
    "characters_wire",
    "creator",
    "decode_any",
    "deserialize",
    "deserialize_in_python",
    "each_unpacker",
    "encode_any",
    "four_zeros",
    "numeric",
    "octets_wire",
    "packer",
    "padded_strings_wire",
    "padded_wire",
    "reader_of",
    "repeat",
    "serialize",
    "serialize_in_python",
    "strings",
    "strings_wire",
    "unpack_from",
    "unpacker",
    "wire",
    "writer_of",
    "wstring",
    "wstring_wire",
    "wstrings",
    "wstrings_wire",
]

four_zeros = bytes(4)
_LARGE_TEXT = 256  # bytes; a struct.Struct for a larger one is not kept


if TYPE_CHECKING:

    def serialize(message: Any) -> bytes:
        """The CDR form of a message, as it goes over the wire: XCDR1, little endian, with the 4-byte header.

        Works for generated classes, ours and rosidl's. Raises SerializationError, with the path of the field,
        for a value that the wire cannot hold: a wrong type (an int in a float field, None), an integer out of
        range, too many elements or characters for the bound, a NUL or half of a surrogate pair in a string.
        """
        ...

    @overload
    def deserialize(data: Buffer, cls: HasViews[ViewsT], *, views: Literal[True]) -> ViewsT: ...
    @overload
    def deserialize(data: Buffer, cls: type[MessageT], *, views: bool = False) -> MessageT: ...
    def deserialize(data: Any, cls: Any, *, views: bool = False) -> Any:
        """The message of class `cls` in these bytes, of either byte order. Ignores trailing bytes.

        With `views`, sequences of numbers are numpy arrays that show these bytes, and copy them when they are
        first written to (`ifgen_runtime.views.SequenceView`). Without it, the message owns its memory.

        Raises DeserializationError, with the path of the field, if the bytes hold no such message. Sequences
        and strings over their bound are refused, although compiled type supports accept them. TypeError if
        `cls` is not a message class.
        """
        ...


def __getattr__(name: str) -> Any:
    """`serialize` and `deserialize`, in C or in Python. Who asks for them is about to use them."""
    if name not in ("serialize", "deserialize"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from ifgen_runtime.codec.choice import chosen  # message packages do without

    native = chosen().extension
    function = getattr(native, name) if native else globals()[f"{name}_in_python"]
    globals()[name] = function
    return function


def serialize_in_python(message: Any) -> bytes:
    """`serialize`, for any object."""
    try:
        return message.__serialize__()  # type: ignore[no-any-return]
    except AttributeError:
        return encode_any(message)


def deserialize_in_python(data: Any, cls: Any, *, views: bool = False) -> Any:
    """`deserialize`, for any data and any class."""
    if data.__class__ is not bytes:
        data = _as_bytes(data, cls)
    if views:
        return viewing.decoders[cls](data)
    try:
        return cls.__deserialize__(data)
    except AttributeError:
        return decode_any(data, cls)


def _as_bytes(data: Any, cls: type[Any]) -> bytes:
    try:
        return memoryview(data).tobytes()
    except TypeError:
        from ifgen_runtime.errors import DeserializationError  # only now

        if isinstance(data, type):
            raise TypeError("deserialize() takes the bytes first, and the class second") from None
        raise DeserializationError(cls.__name__, f"expected bytes, got {type(data).__name__}") from None


def attach_codec(
    cls: type[Any],
    encode: Callable[[Any], bytes],
    decode: Callable[[bytes], Any],
    *nested: type[Any],
    table: tuple[Any, ...] = (),
) -> None:
    """Give a generated class its codec; `nested` are the classes of the fields that hold messages.

    `table` is for the codec in C: the text of the rows and the classes that they refer to. Modules of an
    older ifgen have none.
    """
    if byteorder == "big":  # the generated functions copy numbers from memory unchanged
        encode, decode = encode_any, lambda data: decode_any(data, cls)
    cls.__nested__ = nested
    if table:
        cls.__codec__ = encode, decode, table  # for choice.attached, when it is first used
        return
    cls.__serialize__ = encode
    cls.__deserialize__ = staticmethod(decode)


def attach_parts(cls: type[Any], write: Write, read: Read) -> None:
    """Give a large generated class what those call that hold its messages."""
    cls.__write__ = write
    cls.__read__ = read


def writer_of(cls: type[Any]) -> Write:
    """The function that appends the parts of a message to a list, from a position to the one it returns."""
    return getattr(cls, "__write__", _write_any)


def reader_of(cls: type[Any]) -> Read:
    """The function that fills a message in from a position, and returns where it ends."""
    return getattr(cls, "__read__", _read_any)


def _write_any(message: Any, out: list[Any], p: int) -> int:
    """For classes that rosidl compiled, or an ifgen to which they were not large."""
    from ifgen_runtime.codec.encoding import encode_part  # most programs never come here

    part = encode_part(message, p & 7)
    out.append(part)
    return p + len(part)


def _read_any(message: Any, data: bytes, view: memoryview, words: memoryview, p: int) -> int:
    from ifgen_runtime.codec.decoding import Reader  # most programs never come here

    reader = Reader(data, "<", p)
    reader.fill(message)
    return reader.position


def encode_any(message: Any) -> bytes:
    """The result of a generated function that met an unexpected value."""
    from ifgen_runtime.codec.encoding import encode_any  # most programs never come here

    return encode_any(message)


def decode_any(data: bytes, cls: type[Any], views: object = None) -> Any:
    """The result of a generated function that met unexpected bytes."""
    from ifgen_runtime.codec.decoding import decode_any  # most programs never come here

    return decode_any(data, cls, views=views is not None)


def creator(cls: type[Any]) -> Callable[[], Any]:
    """A function that makes an instance of a message class whose fields are not set yet."""
    # rosidl's compiled classes keep the switch for checks in a slot; ours inherit a property.
    if "_check_fields" not in vars(cls) or not _is_slot(vars(cls)["_check_fields"]):
        return partial(object.__new__, cls)

    def create() -> Any:
        message: Any = object.__new__(cls)
        message._check_fields = False
        return message

    return create


def _is_slot(attribute: object) -> bool:
    from types import MemberDescriptorType  # most programs never come here

    return isinstance(attribute, MemberDescriptorType)


def packer(layout: str) -> Callable[..., bytes]:
    """The function that packs values of this layout."""
    return Struct(layout).pack


class _AroundText(dict[int, "Callable[..., bytes]"]):
    """Size of the strings in the middle -> the function that packs a run around them."""

    __slots__ = ("_behind", "_layout")

    def __init__(self, layout: str, behind: dict[int, str]) -> None:
        self._layout = layout
        self._behind = behind

    def __missing__(self, size: int) -> Callable[..., bytes]:
        pack = Struct(f"{self._layout}{size}s{self._behind[size & 7]}").pack
        if size < _LARGE_TEXT:
            self[size] = pack
        return pack


def around_text(layout: str, behind: dict[int, str]) -> _AroundText:
    """The functions that pack values of `layout`, a string, and more values, by the size of the string.

    `behind` has the layout after them by the size modulo 8, padding included.
    """
    return _AroundText(layout, behind)


def unpacker(layout: str) -> Callable[[bytes, int], tuple[Any, ...]]:
    """The function that unpacks values of this layout from a buffer and an offset."""
    return Struct(layout).unpack_from


def each_unpacker(layout: str) -> Callable[[memoryview], Any]:
    """The function that unpacks values of this layout again and again."""
    return Struct(layout).iter_unpack


def booleans_wire(values: list[bool]) -> bytes:
    """One byte a boolean; TypeError for anything else."""
    if not {bool}.issuperset(map(type, values)):
        raise TypeError
    return bytes(values)


def characters_wire(values: list[str]) -> bytes:
    """One byte a character; TypeError or UnicodeEncodeError for anything that is not one up to U+00FF."""
    if not ({str}.issuperset(map(type, values)) and {1}.issuperset(map(len, values))):
        raise TypeError
    return "".join(values).encode("latin-1")


def octets_wire(values: list[bytes]) -> bytes:
    """The octets; TypeError for anything that is not `bytes` of length 1."""
    if not ({bytes}.issuperset(map(type, values)) and {1}.issuperset(map(len, values))):
        raise TypeError
    return b"".join(values)
