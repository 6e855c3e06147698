"""Messages of all kinds of fields, for tests of whatever carries them: empty, large, and at the limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Duration, Time

from test_msgs.msg import (
    Arrays,
    BasicTypes,
    BoundedPlainSequences,
    BoundedSequences,
    Builtins,
    Constants,
    Defaults,
    Empty,
    MultiNested,
    Nested,
    Strings,
    UnboundedSequences,
    WStrings,
)


def _limits(bits: int, *, signed: bool) -> tuple[int, int, int]:
    """Zero, the greatest and the least integer of so many bits."""
    return (0, 2 ** (bits - 1) - 1, -(2 ** (bits - 1))) if signed else (0, 2**bits - 1, 0)


# For each elementary type: nothing, much, and little.
_VALUES: dict[str, tuple[Any, Any, Any]] = {
    "bool": (False, True, False),
    "byte": (b"\x00", b"\xff", b"\x00"),
    "char": _limits(8, signed=False),
    "float32": (0.0, 1.125, -2.125),
    "float64": (0.0, 1.125, -2.125),
}
for _bits in (8, 16, 32, 64):
    _VALUES[f"int{_bits}"] = _limits(_bits, signed=True)
    _VALUES[f"uint{_bits}"] = _limits(_bits, signed=False)

_TEXTS = ("", "Hello, robot", "Grüß Gott, Füße")
_WIDE_TEXTS = ("", "Hello, robot", "Grüß Gott, Füße", "こんにちは世界")
_LONG = 10_000  # characters
_BOUND = 22  # characters of a bounded string
_MANY = 1_000  # elements


def int_from_uint(value: int, nbits: int) -> int:
    """The signed integer with the same `nbits` lowest bits."""
    value %= 1 << nbits
    return value - (1 << nbits) if value >> (nbits - 1) else value


def _elements(count: int, **more: tuple[Any, ...]) -> dict[str, Any]:
    """For each field `<type>_values` so many elements, in turn those of `_VALUES` and of `more`."""
    return {
        f"{name}_values": [values[index % len(values)] for index in range(count)]
        for name, values in (_VALUES | more).items()
    }


def _messages() -> dict[str, tuple[Any, ...]]:
    """Elements for the sequences of messages."""
    return {
        "basic_types": tuple(get_msg_basic_types()),
        "constants": (Constants(),),
        "defaults": (Defaults(),),
    }


def get_msg_builtins() -> list[Builtins]:
    """A negative duration and a time before the epoch."""
    return [
        Builtins(
            duration_value=Duration(sec=-1_234_567_890, nanosec=123_456_789),
            time_value=Time(sec=-1_234_567_890, nanosec=987_654_321),
        )
    ]


def get_msg_empty() -> list[Empty]:
    """The message with no fields."""
    return [Empty()]


def get_msg_basic_types() -> list[BasicTypes]:
    """Zeros, the greatest values, the least, and ones."""
    messages = [
        BasicTypes(**{f"{name}_value": values[index] for name, values in _VALUES.items()})
        for index in range(3)
    ]
    ones: dict[str, Any] = {f"{name}_value": type(values[0])(1) for name, values in _VALUES.items()}
    return [*messages, BasicTypes(**(ones | {"byte_value": b"\x01"}))]


def get_msg_constants() -> list[Constants]:
    """The message that has constants only."""
    return [Constants()]


def get_msg_defaults() -> list[Defaults]:
    """The message whose fields have default values."""
    return [Defaults()]


def get_msg_strings() -> list[Strings]:
    """No text, ASCII, more than ASCII, and a long one; bounded strings are full then."""
    digits = "0123456789" * (_LONG // 10)
    return [
        *(Strings(string_value=text, bounded_string_value=text) for text in _TEXTS),
        Strings(string_value=digits, bounded_string_value=digits[:_BOUND]),
    ]


def get_msg_nested() -> list[Nested]:
    """Each of `get_msg_basic_types` as a field."""
    return [Nested(basic_types_value=message) for message in get_msg_basic_types()]


def get_msg_arrays() -> list[Arrays]:
    """Arrays of three, which is all that they can hold."""
    return [Arrays(**_elements(3, string=_TEXTS, **_messages()), alignment_check=1)]


def get_msg_unbounded_sequences() -> list[UnboundedSequences]:
    """Sequences of none, one, two and many elements, and those of a new message."""
    return [
        *(
            UnboundedSequences(**_elements(count, string=_TEXTS, **_messages()), alignment_check=count)
            for count in (0, 1, 2, _MANY)
        ),
        UnboundedSequences(),
    ]


def get_msg_bounded_sequences() -> list[BoundedSequences]:
    """Sequences up to their bound, and those of a new message."""
    full = _elements(3, string=_TEXTS, **_messages())
    return [BoundedSequences(**full, alignment_check=2), BoundedSequences()]


def get_msg_bounded_plain_sequences() -> list[BoundedPlainSequences]:
    """As `get_msg_bounded_sequences`, for the message without strings."""
    full = _elements(3, **_messages())
    return [BoundedPlainSequences(**full, alignment_check=2), BoundedPlainSequences()]


def get_msg_multi_nested() -> list[MultiNested]:
    """Messages with sequences, in sequences of three."""
    inner: dict[str, list[Any]] = {
        "arrays": [*get_msg_arrays(), Arrays(), Arrays()],
        "bounded_sequences": [*get_msg_bounded_sequences(), BoundedSequences()],
        "unbounded_sequences": get_msg_unbounded_sequences()[:3],
    }
    fields: dict[str, Any] = {
        f"{kind}_of_{name}": messages
        for kind in ("array", "bounded_sequence", "unbounded_sequence")
        for name, messages in inner.items()
    }
    return [MultiNested(**fields)]


def get_msg_wstrings() -> list[WStrings]:
    """Wide texts in sequences, and alone."""
    first, *others = (WStrings(wstring_value=text) for text in _WIDE_TEXTS)
    first.array_of_wstrings = list(_WIDE_TEXTS[1:])
    first.bounded_sequence_of_wstrings = list(_WIDE_TEXTS[2:])
    first.unbounded_sequence_of_wstrings = list(_WIDE_TEXTS)
    return [first, *others]


_FIXTURES: dict[str, Callable[[], list[Any]]] = {
    "Arrays": get_msg_arrays,
    "BasicTypes": get_msg_basic_types,
    "BoundedPlainSequences": get_msg_bounded_plain_sequences,
    "BoundedSequences": get_msg_bounded_sequences,
    "Builtins": get_msg_builtins,
    "Constants": get_msg_constants,
    "Defaults": get_msg_defaults,
    "Empty": get_msg_empty,
    "MultiNested": get_msg_multi_nested,
    "Nested": get_msg_nested,
    "Strings": get_msg_strings,
    "UnboundedSequences": get_msg_unbounded_sequences,
    "WStrings": get_msg_wstrings,
}


def get_test_msg(message_name: str) -> list[Any]:
    """The messages of a type, by its name without the package; NotImplementedError for an unknown one."""
    if message_name not in _FIXTURES:
        raise NotImplementedError(f"there are no fixtures of a message '{message_name}'")
    return _FIXTURES[message_name]()
