"""Options of `ifgen run` that stand after a program, where everybody types them first."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Final

TRANSPORTS: Final = ("local", "rclpy", "auto")
_FLAGS: Final = ("--lockstep", "--generate")
_ENDS: Final = ("--", "--ros-args")


def take(words: Sequence[str], given: Collection[str]) -> tuple[list[str], dict[str, str]]:
    """Separate the words of programs from options of `ifgen run` that are among them; returns both.

    `--transport` with a transport or a word spelled like one, `--lockstep` and `--generate` count, up to
    `--` or `--ros-args` of each program. None counts that is among those `given` before the programs, or
    that the file of its program has in quotes: then it is the program's.
    """
    left: list[str] = []
    found: dict[str, str] = {}
    text: str | None = None  # of the program whose arguments are being read
    is_open = True
    rest = iter(range(len(words)))
    for index in rest:
        word = words[index]
        name, equals, value = word.partition("=")
        if text is None or word == ":":
            text, is_open = (None, True) if word == ":" else (_text_of(word), True)
        elif word in _ENDS:
            is_open = False
        elif is_open and name not in given and not _is_known(name, text):
            value = value if equals else "".join(words[index + 1 : index + 2])
            if name == "--transport" and get_close_matches(value, TRANSPORTS, n=1):
                found[name] = value
                if not equals:
                    next(rest)
                continue
            if word in _FLAGS:
                found[word] = ""
                continue
        left.append(word)
    return left, found


def _is_known(option: str, text: str) -> bool:
    return f"'{option}" in text or f'"{option}' in text


def _text_of(program: str) -> str:
    with suppress(OSError, ValueError):
        if Path(program).is_file():
            return Path(program).read_text(encoding="utf-8", errors="replace")
    return ""
