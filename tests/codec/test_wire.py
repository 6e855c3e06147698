"""The bytes, written by hand from the rules of CDR, with their padding."""

from __future__ import annotations

from typing import Any

import pytest
from ifgen_runtime import deserialize, serialize

from .support import Classes

ALIGNED = {"a": 1.0, "b": 2, "c": 3}
ONE, MINUS_TWO = "00000000 0000f03f", "00000000 000000c0"

DEEP = (
    "00000000"  # first
    "00 000000"  # gap, then to the count
    "00000000"  # second
    "00000000"  # to the double
    f"{'00' * 8} 00000000"  # number, pairs
    "00 000000 00000000"  # flag, tails
    "00000000"  # numbers: no double, no padding
    "01000000 00 00 0000 01000000 00 00"  # two_tails
    "0000 00000000 00000000"  # mixed, empties
    "00 000000 01000000 00 000000 00000000"  # last[0]
    "00 000000 01000000 00 000000 00000000"  # last[1]
)
BOUNDS = (
    "01000000 00 000000 00000000"  # text, texts
    "01000000 00 000000 02000000 6100"  # pair
    "0000 00000000 01000000"  # few_texts, the count of numbers
    f"00000000 {ONE}"
    "00000000 00000000 00000000 00000000 00000000"  # octets, flags, raw, empties, pairs
)

# Type, fields, bytes after the header.
CASES: list[tuple[str, dict[str, Any], str]] = [
    ("Empty", {}, "00"),
    ("Pair", {}, "01000000 00 000000 01000000 00"),
    ("Pair", {"key": "abc", "value": "de"}, "04000000 61626300 03000000 646500"),
    ("Pair", {"key": "é", "value": "𝄞"}, "03000000 c3a900 00 05000000 f09d849e00"),
    ("Tail", {"text": "ab", "flag": 7}, "03000000 616200 07"),
    ("Tail", {"text": "", "flag": 7}, "01000000 00 07"),
    ("Mixed", {"a": 1, "b": 1.0, "c": 2}, f"01 00000000000000 {ONE} 0200"),
    ("Aligned", ALIGNED, f"{ONE} 02 000000 03000000"),
    # An element of Mixed ends 2 bytes after a double; the next one begins there, with its own padding.
    (
        "Shifting",
        {"mixed": [("Mixed", {"a": 1, "b": 1.0, "c": 2}), ("Mixed", {"a": 3, "b": -2.0, "c": 4})]},
        "00000000 02000000"
        f"01 00000000000000 {ONE} 0200 03 00000000 00 {MINUS_TWO} 0400"
        f"00 000000 0000 {'00' * 8} 0000 00 0000000000 {'00' * 8} 0000 00 0000000000 {'00' * 8} 0000"
        f"0000 00000000 00 00000000000000 {'00' * 16} {'00' * 16}",
    ),
    # A char is one byte, and never aligned. Measured on rosidl's compiled classes.
    (
        "Letters",
        {
            **{"first": "a", "aligned": 1.0, "middle": "b", "triple": ["c", "d", "e"], "number": 5},
            **{"many": ["f"], "wide": 6, "few": ["g", "h"], "text": "i", "last": "j"},
            "letters": [
                ("Letter", {"a": "k", "b": 1.0, "c": "l"}),
                ("Letter", {"a": "k", "b": 1.0, "c": "l"}),
            ],
            "pair": [("Letter", {"a": "m", "b": -2.0, "c": "n"}), ("Letter", {"a": "o", "c": "p"})],
        },
        f"61 00000000000000 {ONE} 62 636465 0500 0000 01000000 66 000000 06000000 00000000 02000000 6768 0000"
        f"02000000 6900 6a 00 02000000 6b 000000 {ONE} 6c 6b 000000000000 {ONE} 6c"
        f"6d 000000000000 {MINUS_TWO} 6e 6f 000000000000 00000000 00000000 70",
    ),
    ("Letter", {"a": "ÿ", "c": "\0"}, f"ff {'00' * 7} {'00' * 8} 00"),
    # A wstring counts code units, which take 4 bytes each, without an end mark.
    (
        "Wide",
        {"before": 1, "text": "aé𝄞", "between": 2, "bounded": "", "many": [], "pair": ["", "b"], "after": 3},
        "01 000000 04000000 61000000 e9000000 34d80000 1edd0000 02 000000 00000000"
        "00000000 00000000 01000000 62000000 03",
    ),
    # There is no padding after the count of an empty sequence, even of doubles.
    ("Deep", {"last": [("Status", {}), ("Status", {})]}, DEEP),
    ("Bounds", {"pair": ["", "a"], "numbers": [1.0]}, BOUNDS),
]


def make(classes: Classes, name: str, fields: dict[str, Any]) -> Any:
    values = {
        key: [make(classes, *item) if isinstance(item, tuple) else item for item in value]
        if isinstance(value, list)
        else value
        for key, value in fields.items()
    }
    return classes[f"codec_msgs/msg/{name}"](**values)


@pytest.mark.parametrize(
    ("name", "fields", "body"), CASES, ids=[f"{n}-{i}" for i, (n, *_) in enumerate(CASES)]
)
def test_bytes(classes: Classes, name: str, fields: dict[str, Any], body: str) -> None:
    message = make(classes, name, fields)
    expected = bytes.fromhex("00010000" + body)
    assert serialize(message).hex(" ", 4) == expected.hex(" ", 4)
    assert deserialize(expected, type(message)) == message


def test_padding_is_zero_whatever_is_sent(classes: Classes) -> None:
    """Values of all ones leave zeros in between."""
    cls = classes["codec_msgs/msg/Scalars"]
    message = cls(
        flag=True, int64_value=-1, raw=b"\xff", uint64_value=2**64 - 1, character=255, int32_value=-1
    )
    padding = "00" * 7
    assert (
        serialize(message)
        .hex()
        .startswith(f"0001000001{padding}{'ff' * 8}ff{padding}{'ff' * 8}ff000000{'ff' * 4}")
    )


def test_tolerated(classes: Classes) -> None:
    """We read every payload that compiled type supports read."""
    pair = classes["codec_msgs/msg/Pair"]

    def key(body: str) -> str:
        text: str = deserialize(bytes.fromhex("00010000" + body), pair).key
        return text

    assert key("00000000 01000000 00") == "", "a string of length 0"
    assert key("03000000 616263 00 01000000 00") == "abc", "no NUL at the end"
    assert key("05000000 61006200 00 000000 01000000 00") == "a", "nothing behind a NUL"
    assert key("05000000 61ff6200 00 000000 01000000 00") == "a\ufffdb", "bytes that are not UTF-8"
    tail = classes["std_msgs/msg/Bool"]
    assert deserialize(bytes.fromhex("00010000 02"), tail).data is True, "any boolean but 0"
    options = bytes.fromhex("0001ffff 01")
    assert deserialize(options, tail).data is True, "options in the header"
