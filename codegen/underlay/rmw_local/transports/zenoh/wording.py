"""The words of Zenoh's errors, which are made for those who work on Zenoh."""

from __future__ import annotations

import re
from typing import Final

_IN_SOURCES: Final = re.compile(r" at /\S+?\.rs:\d+\.?")
"""A place in the code of Zenoh."""
_QUOTED: Final = re.compile(r"""(?:msg: |Str\()"((?:[^"\\]|\\.)*)""")
_PLACES: Final = (re.compile(r"--> (\d+):(\d+)"), re.compile(r"line: (\d+), column: (\d+)"))


def reason(error: Exception) -> str:
    """Return what an error says, in one line and without the places in Zenoh's code."""
    text = _IN_SOURCES.sub("", str(error))
    if quoted := _QUOTED.search(text):
        text = quoted[1].replace("\\n", "\n").replace('\\"', '"')
    text = text.rpartition("\n  = ")[2]  # after a picture of the place
    return " ".join(text.split()).rstrip(".!")


def place(error: Exception) -> str:
    """Return the place in the user's file that an error names, as `, line 2, column 1`, or nothing."""
    found = next(filter(None, (pattern.search(str(error)) for pattern in _PLACES)), None)
    return f", line {found[1]}, column {found[2]}" if found else ""
