"""The attachment of messages, requests and responses: number, source stamp, gid."""

from __future__ import annotations

import struct
from typing import Final, NamedTuple

_WITH_LENGTH: Final = struct.Struct("<qqB16s")  # as released, with the length of the gid: 33 bytes
_WITHOUT_LENGTH: Final = struct.Struct("<qq16s")  # newer: 32 bytes
GID: Final = 16
"""Bytes of a gid."""

_NAMED: Final = 77  # bytes, of rmw_zenoh before 0.2.4, which writes the names of the fields as well


class Attachment(NamedTuple):
    """A number from 1, the source stamp [ns], and the gid of a publisher or a client."""

    number: int
    stamp: int
    gid: bytes


def pack(number: int, stamp: int, gid: bytes) -> bytes:
    """The 33 bytes of an attachment."""
    return _WITH_LENGTH.pack(number, stamp, GID, gid)


def unpack(data: bytes) -> Attachment:
    """Read an attachment of either length; raises ValueError."""
    if len(data) == _WITH_LENGTH.size:
        number, stamp, length, gid = _WITH_LENGTH.unpack(data)
        if length == GID:
            return Attachment(number, stamp, gid)
        raise ValueError(f"an attachment has a gid of {length} bytes, expected {GID}")
    if len(data) == _WITHOUT_LENGTH.size:
        return Attachment(*_WITHOUT_LENGTH.unpack(data))
    if len(data) == _NAMED:
        raise ValueError("an attachment has 77 bytes: the sender needs rmw_zenoh 0.2.4 or newer")
    raise ValueError(f"an attachment has {len(data)} bytes, expected 33 or 32")
