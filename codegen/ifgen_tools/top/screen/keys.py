"""The keys in what a terminal sends."""

from __future__ import annotations

import re
from typing import Final

_NAMED: Final = {
    "\x1b[A": "up",
    "\x1b[B": "down",
    "\x1b[C": "right",
    "\x1b[D": "left",
    "\x1bOA": "up",  # in the mode that some programs leave behind
    "\x1bOB": "down",
    "\x1bOC": "right",
    "\x1bOD": "left",
    "\x1b[H": "home",
    "\x1b[F": "end",
    "\x1bOH": "home",
    "\x1bOF": "end",
    "\x1b[1~": "home",
    "\x1b[4~": "end",
    "\x1b[5~": "page up",
    "\x1b[6~": "page down",
    "\x1b[Z": "backtab",
    "\t": "tab",
    "\r": "enter",
    "\n": "enter",
    "\x7f": "backspace",
    "\b": "backspace",
    "\x04": "q",  # Ctrl-D
    "\x1b": "escape",
}
_TOKEN: Final = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1bO[A-Za-z]|\x1b|.", re.DOTALL)


def keys(data: bytes) -> list[str]:
    """The names of keys, or what they print; those without a meaning are left out."""
    found = []
    for token in _TOKEN.findall(data.decode("utf-8", "replace")):
        key = _NAMED.get(token, token if len(token) == 1 and token.isprintable() else "")
        if key:
            found.append(key)
    return found
