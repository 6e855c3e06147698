"""Exchange messages with the compiled type supports of the installed rclpy; runs in a process of its own.

    python codec_exchange.py FOLDER EXAMPLES [WORD]

FOLDER is for the generated classes, EXAMPLES the number of messages of each type whose name has WORD in it. Prints one
JSON object: how many types were compared, and what went wrong.
"""

from __future__ import annotations

import json
import random
import struct
import sys
import warnings
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "codec"))

from big_endian import big_endian  # type: ignore[import-not-found]  # found by sys.path
from hypothesis import HealthCheck, given, seed, settings
from ifgen_runtime import DeserializationError, deserialize, from_dict, serialize, to_dict, to_json
from ifgen_runtime.field_types import message_class
from strategies import messages  # type: ignore[import-not-found]
from support import Classes, generate  # type: ignore[import-not-found]

MUTATIONS = 12
HUGE = (0xFFFFFFFF, 0x10000001, 0x00FFFFFF, 300)


def compiled_class(name: str) -> type[Any] | None:
    """The class of this type that the wheels bring, or None."""
    package, folder, cls = name.split("/")
    try:
        return message_class(f"{package}.{folder}", cls)
    except (ImportError, AttributeError):
        return None


class Exchange:
    """One type, ours and theirs."""

    def __init__(self, ours: type[Any], theirs: type[Any]) -> None:
        from rclpy.serialization import deserialize_message, serialize_message

        self.ours = ours
        self.theirs = theirs
        self.send, self.receive = serialize_message, deserialize_message

    def run(self, examples: int) -> None:
        """Messages of any content."""

        @seed(1)
        @settings(
            max_examples=examples, deadline=None, database=None, suppress_health_check=list(HealthCheck)
        )
        @given(messages(self.ours))
        def exchange_one(message: Any) -> None:
            if not bom_is_lost(message):
                self.check(message)
                self.check_mutations(message)

        exchange_one()

    def check(self, message: Any) -> None:
        """Check both directions, both byte orders, and our codec on their objects."""
        data, plain = serialize(message), to_dict(message)
        received = self.receive(data, self.theirs)
        assert to_dict(received) == plain, "rclpy read something else"
        assert to_dict(self.receive(big_endian(message), self.theirs)) == plain, "in big endian"
        compiled = from_dict(self.theirs, plain)
        sent = bytes(self.send(compiled))
        assert deserialize(sent, self.ours) == message, "we read something else"
        assert len(sent) >= len(data), "rclpy sends fewer bytes"
        assert all(b in (a, 0) for a, b in zip(sent, data, strict=False)), "not only padding differs"
        assert serialize(compiled) == data, "our codec on their object"
        assert to_dict(deserialize(data, self.theirs)) == plain, "our codec into their class"

    def check_mutations(self, message: Any) -> None:
        """Check that rclpy accepts every broken payload that we accept, and reads the same from it."""
        source = random.Random(repr(message))
        for _ in range(MUTATIONS):
            payload = bytearray(serialize(message))
            place = source.randrange(4, len(payload))
            match source.randrange(4):
                case 0:
                    del payload[place:]
                case 1:
                    payload[place] ^= 1 << source.randrange(8)
                case 2:
                    payload[place & -4 : (place & -4) + 4] = struct.pack("<I", source.choice(HUGE))
                case _:
                    payload += bytes(source.randrange(9))
            try:
                mine = deserialize(bytes(payload), self.ours)
            except DeserializationError:
                continue
            assert to_json(self.receive(bytes(payload), self.theirs)) == to_json(mine), payload.hex()


def bom_is_lost(message: Any) -> bool:
    """Whether a wstring begins with U+FEFF, which the compiled code drops."""
    return "\ufeff" in to_json(message)


def exchange(classes: Classes, examples: int, word: str) -> tuple[list[str], dict[str, str]]:
    """Compare every type that both have; returns the names of the compared types, and problems by name."""
    compared: list[str] = []
    problems: dict[str, str] = {}
    for name in sorted(classes):
        theirs = compiled_class(name) if word in name else None
        if theirs is None:
            continue
        compared.append(name)
        try:
            Exchange(classes[name], theirs).run(examples)
        except Exception as problem:
            problems[name] = f"{type(problem).__name__}: {problem} {getattr(problem, '__notes__', '')}"
    return compared, problems


VERDICTS = {
    # Type, body of the payload -> whether (we, rclpy) read it. Where they differ, decoding.py says why.
    "string of length 0": ("std_msgs/msg/String", "00010000 00000000", True, True),
    "no NUL": ("std_msgs/msg/String", "00010000 02000000 6162", True, True),
    "behind a NUL": ("std_msgs/msg/String", "00010000 04000000 61006200", True, True),
    "not UTF-8": ("std_msgs/msg/String", "00010000 03000000 ff6100", True, True),
    "truncated": ("std_msgs/msg/String", "00010000 09000000 6162", False, False),
    "huge": ("std_msgs/msg/String", "00010000 ffffffff 6162", False, False),
    "no header": ("std_msgs/msg/Bool", "0001", False, False),
    "any boolean": ("std_msgs/msg/Bool", "00010000 05", True, True),
    "header options": ("std_msgs/msg/Bool", "0001ffff 01", True, True),
    "parameter list": ("std_msgs/msg/Bool", "00030000 01", False, True),
    "over the bound": (
        "test_msgs/msg/BoundedPlainSequences",
        "00010000 04000000 01010101" + "00000000" * 40,
        False,
        True,
    ),
}


def verdicts(classes: Classes) -> dict[str, str]:
    """The payloads for which one of the two verdicts differs from `VERDICTS`."""
    wrong: dict[str, str] = {}
    for title, (name, payload, mine, theirs) in VERDICTS.items():
        compiled = compiled_class(name)
        if compiled is None:
            continue
        pair, data = Exchange(classes[name], compiled), bytes.fromhex(payload)
        readings: list[Any] = []
        for read, cls in ((deserialize, pair.ours), (pair.receive, pair.theirs)):
            try:
                readings.append(to_dict(read(data, cls)))
            except Exception as problem:
                readings.append(problem)
        found = [not isinstance(reading, Exception) for reading in readings]
        if found != [mine, theirs] or (all(found) and readings[0] != readings[1]):
            wrong[title] = repr(readings)
    return wrong


def main() -> None:
    """Run and report."""
    warnings.simplefilter("ignore")
    classes = generate(Path(sys.argv[1]))
    compared, problems = exchange(classes, int(sys.argv[2]), *(sys.argv[3:] or [""]))
    print(json.dumps({"compared": compared, "problems": problems, "verdicts": verdicts(classes)}))


if __name__ == "__main__":
    main()
