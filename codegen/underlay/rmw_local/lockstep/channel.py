"""The way between the coordinator of a lockstep run and one of its processes: whole objects over a socket.

Both ends are processes of one program, so what comes is trusted. They take turns: while one sends much, the
other one waits for it. So neither can be blocked by the other.
"""

from __future__ import annotations

import pickle
import socket
from typing import Any, Final

_HEAD: Final = 8  # bytes that say how long the rest is
_AT_ONCE: Final = 1 << 17  # bytes


class Channel:
    """One end."""

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        self._rest = b""  # that came with the last object

    def be_patient(self, seconds: float) -> None:
        """Wait no longer for the other end [s, real time]; at first there is no limit."""
        self._end.settimeout(seconds)

    def send(self, what: Any) -> None:
        """Send an object. Raises OSError if the other end is gone."""
        data = pickle.dumps(what, pickle.HIGHEST_PROTOCOL)
        self._end.sendall(len(data).to_bytes(_HEAD, "little") + data)

    def receive(self) -> Any:
        """Wait for an object. Raises EOFError if the other end is gone, TimeoutError if it takes too long."""
        data = self._rest or self._some()
        while len(data) < _HEAD:
            data += self._some()
        size = int.from_bytes(data[:_HEAD], "little") + _HEAD
        if len(data) < size:
            parts, left = [data], size - len(data)
            while left > 0:
                part = self._some()
                parts.append(part)
                left -= len(part)
            data = b"".join(parts)
        self._rest = data[size:]
        return pickle.loads(memoryview(data)[_HEAD:size])

    def close(self) -> None:
        """Close it."""
        self._end.close()

    def _some(self) -> bytes:
        try:
            data = self._end.recv(_AT_ONCE)
        except ConnectionResetError:
            data = b""
        if not data:
            raise EOFError("the other end is gone")
        return data
