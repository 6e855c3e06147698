"""Reads the files that users write, and says why one cannot be read."""

from __future__ import annotations

import errno
import json
import os
import stat
from pathlib import Path
from typing import Any, Final

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shown_path
from ifgen.reading import storage

MAX_SIZE: Final = 4 * 2**20
"""Bytes of a file that somebody may have written: a hundred times what the largest interface has."""

MAX_GENERATED: Final = 2**28
"""Bytes of a file that ifgen may have written: ten times what its largest module has."""

_NEITHER_WAIT_NOR_PASS_ON: Final = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)


def read_source(path: Path) -> Source:
    """The text of a file, with plain line ends; InputError if it cannot be read or is not UTF-8."""
    data = read_bytes(path)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError([_not_utf8(path, data, error)]) from None
    return Source(path, text.replace("\r\n", "\n") if "\r" in text else text, storage.revision(path))


def read_bytes(path: Path) -> bytes:
    """The text of a file. Raises InputError if it cannot be read, is not a file, or is too large."""
    try:
        return read_limited(path)
    except OSError as error:
        raise InputError([unreadable(path, error)]) from None


def text_if_there(path: Path) -> str | None:
    """The text of a file; None if it cannot be read or is not UTF-8."""
    try:
        return read_limited(path).decode("utf-8")
    except (OSError, ValueError):
        return None


def read_json(path: Path) -> Any:
    """The value in a file of JSON. Raises OSError as `read_limited` does, and ValueError if it is no JSON."""
    return json_of(read_limited(path, MAX_GENERATED))


def json_of(data: bytes) -> Any:
    """The value that is written as JSON. Raises ValueError if it is none."""
    try:
        return json.loads(data.decode("utf-8"))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def read_limited(path: Path, at_most: int = MAX_SIZE) -> bytes:
    """The bytes of a file. Raises OSError, also for a pipe, a device, and more than `at_most` bytes.

    Those would keep it waiting, or fill all memory.
    """
    data = storage.read_snapshot(path)
    if data is None:
        descriptor = os.open(path, os.O_RDONLY | _NEITHER_WAIT_NOR_PASS_ON | getattr(os, "O_BINARY", 0))
        try:
            status = os.fstat(descriptor)
            if stat.S_ISDIR(status.st_mode):
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
            if not stat.S_ISREG(status.st_mode):
                raise OSError(errno.EINVAL, "it is not a file, but a pipe, a device or a socket", str(path))
            data = os.read(descriptor, min(status.st_size, at_most) + 1)
            # Files of the kernel have more in them than they say, and networks may send less at once.
            while 0 < len(data) <= at_most and (part := os.read(descriptor, 2**20)):
                data += part
        finally:
            os.close(descriptor)
    if len(data) > at_most:
        raise OSError(errno.EFBIG, f"it is larger than {at_most // 2**20} MiB", str(path))
    return data


def unreadable(path: Path, error: OSError) -> Diagnostic:
    """Say that a file or a folder cannot be read."""
    return Diagnostic("unreadable-path", f"cannot read {shown_path(path)}: {error.strerror or error}")


def _not_utf8(path: Path, data: bytes, error: UnicodeDecodeError) -> Diagnostic:
    start = len(data[: error.start].decode("utf-8").replace("\r\n", "\n"))
    source = Source(path, data.decode("utf-8", "replace").replace("\r\n", "\n"), storage.revision(path))
    return Diagnostic(
        "not-utf-8",
        f"the file is not UTF-8: byte 0x{data[error.start]:02x} at offset {error.start}",
        Label(Span(source, start, start + 1), "this byte"),
        help="save the file as UTF-8",
    )
