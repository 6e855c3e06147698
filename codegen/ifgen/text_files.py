"""Reads text files, and says why one cannot be read."""

from __future__ import annotations

from pathlib import Path

from ifgen.diagnostics import Diagnostic, InterfaceError, Label, Source, Span, shown_path


def read_source(path: Path) -> Source:
    """The text of a file, with plain line ends; InterfaceError if it cannot be read or is not UTF-8."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InterfaceError([unreadable(path, error)]) from None
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InterfaceError([_not_utf8(path, data, error)]) from None
    return Source(path, text.replace("\r\n", "\n") if "\r" in text else text)


def unreadable(path: Path, error: OSError) -> Diagnostic:
    """Say that a file or a folder cannot be read."""
    return Diagnostic("unreadable-path", f"cannot read {shown_path(path)}: {error.strerror or error}")


def _not_utf8(path: Path, data: bytes, error: UnicodeDecodeError) -> Diagnostic:
    start = len(data[: error.start].decode("utf-8").replace("\r\n", "\n"))
    source = Source(path, data.decode("utf-8", "replace").replace("\r\n", "\n"))
    return Diagnostic(
        "not-utf-8",
        f"the file is not UTF-8: byte 0x{data[error.start]:02x} at offset {error.start}",
        Label(Span(source, start, start + 1), "this byte"),
        help="save the file as UTF-8",
    )
