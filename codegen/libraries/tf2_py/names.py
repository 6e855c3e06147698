"""Names of frames, as arguments of lookups."""

from __future__ import annotations

from collections.abc import Container
from typing import Any

from tf2_py.exceptions import InvalidArgumentException, LookupException


def require(frame: Any, known: Container[str], place: str) -> None:
    """Refuse a name that a lookup cannot use; `place` is where it comes from.

    :raises InvalidArgumentException: if no frame can have such a name.
    :raises LookupException: if no frame has it.
    :raises TypeError: if it is not a string.
    """
    if wrong := _wrong(frame):
        raise InvalidArgumentException(
            f'Invalid argument "{frame}" passed to {place} - in tf2 frame_ids cannot {wrong}'
        )
    if frame not in known:
        raise LookupException(f'"{frame}" passed to {place} does not exist. ')


def complaint(known: Container[str], **frames: Any) -> str:
    """Return the first thing that is wrong with names; empty if they are right.

    :raises TypeError: if one is not a string.
    """
    for argument, frame in frames.items():
        wrong = _wrong(frame)
        if wrong or frame not in known:
            why = f"in tf2 frame_ids cannot {wrong}" if wrong else "frame does not exist"
            return f'Invalid frame ID "{frame}" passed to canTransform argument {argument} - {why}'
    return ""


def _wrong(frame: Any) -> str:
    if not isinstance(frame, str):
        raise TypeError(f"the name of a frame must be a str, got {frame!r}")
    if not frame:
        return "be empty"
    return "start with a '/'" if frame[0] == "/" else ""
