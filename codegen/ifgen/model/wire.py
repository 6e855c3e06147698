"""The bytes of a message as a program: what a codec does, step by step, with all alignment resolved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Primitive = Literal[
    "bool",
    "byte",
    "char",
    "int8",
    "uint8",
    "int16",
    "uint16",
    "int32",
    "uint32",
    "int64",
    "uint64",
    "float32",
    "float64",
    "string",
    "wstring",
    "message",
]
StepKind = Literal["run", "text", "values", "texts", "repeat", "call"]


@dataclass(frozen=True, slots=True)
class Item:
    """One value in a run, or `count` values of a fixed array, at `offset` bytes from the start of the run.

    `size` is that of one value, in bytes. A `placeholder` is the zero byte of the empty message at `path`.
    """

    path: tuple[str, ...]
    primitive: Primitive
    offset: int
    size: int
    count: int | None
    placeholder: bool


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a codec. Positions count from the end of the 4-byte header of a payload.

    Before each step there is padding to a multiple of `align`, which may be 1. `pad` is the number of those
    bytes where it is always the same, None where it depends on what came before. `path` leads from the
    message, or from the element of the next outer `repeat`, to the field. Other members are of some kinds
    only; in JSON those are left out that have their default.

    * `run`: `items` at fixed offsets, `size` bytes in all. Bytes between items are padding.
    * `text`: a string. `wide` ones have a count of UTF-16 units as uint32, then each unit in 4 bytes. Others
      have the count of the UTF-8 bytes and the NUL, as uint32, then these. `text_maximum` bounds characters.
    * `values`: a sequence of `primitive`: a count as uint32 (at most `maximum`), then, if it is not 0,
      padding to `element_align` (`element_pad` bytes where that is always the same), then the values, of
      `element_size` bytes each.
    * `texts`: `count` strings, or a count as uint32 (at most `maximum`) and that number of strings. Each is
      aligned to 4.
    * `repeat`: `count` messages of type `type_name`, or a count as uint32 (at most `maximum`) and that number
      of them: if there is one, padding to `element_align` (`element_pad`), then the `steps` for each. With a
      `stride`, each takes that number of bytes, without padding between them.
    * `call`: the steps in `own` of `type_name`, for the message at `path`.
    """

    kind: StepKind
    path: tuple[str, ...]
    align: int
    pad: int | None
    size: int = 0
    items: tuple[Item, ...] = ()
    wide: bool = False
    text_maximum: int | None = None
    primitive: Primitive | None = None
    count: int | None = None
    maximum: int | None = None
    element_size: int | None = None
    element_align: int = 1
    element_pad: int | None = 0
    type_name: str | None = None
    stride: int | None = None
    steps: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class Wire:
    """The bytes of a message, without the header of 4 bytes.

    `steps` are for a message that stands alone; nested messages are part of them, except large ones, which
    are calls. `own` are for its fields alone, wherever it starts: every nested message is a call. No payload
    is shorter than `min_size`; none is longer than `max_size`, which is None if nothing bounds it. Both are
    exact for a `fixed` size, and count the padding of a message that stands alone. `min_element_size` is the
    least that it takes in another message, without any padding: a count of more than the bytes that are left
    divided by it cannot be true. `align` is the largest alignment in it, `start_align` that of its first
    value, which is all that its start in another message is sure to have.

    A `plain` message has the same bytes in memory as a C structure of its fields has on a little-endian
    machine, so that one copy is enough, where it starts at a multiple of `align`: alone it does; in another
    message only if `start_align` is the same.
    """

    fixed: bool
    plain: bool
    align: int
    min_size: int
    max_size: int | None
    min_element_size: int
    start_align: int
    steps: tuple[Step, ...]
    own: tuple[Step, ...]
