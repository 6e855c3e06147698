"""One file that is passed to `rosidl_generate_interfaces`: its path, and the mistakes in that."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen.diagnostics import Diagnostic, Label, Source, Span, did_you_mean, shorten
from ifgen.reading import storage

if TYPE_CHECKING:
    from ifgen.reading.cmake.interpreter import Call

GENERATE: Final = "rosidl_generate_interfaces"

EXTENSIONS: Final = (".action", ".idl", ".msg", ".srv")
"""The path that rosidl reads."""


class ListedFile:
    """A file relative to the folder of its CMakeLists.txt, or `base:relative` with an absolute base.

    `path` starts with `root`, the package's folder, as that was given; `absolute` is the same, absolute.
    """

    def __init__(self, root: Path, absolute: Path, call: Call, text: str) -> None:
        self.text = text
        self._call = call
        base, colon, self._within = text.rpartition(":")
        self._is_pair = bool(colon)
        if self._is_pair or text.startswith("/") or call.folder != absolute:
            self._relative = os.path.relpath(call.folder / base / self._within, absolute)
        else:
            self._relative = os.path.normpath(text)
        self.path = root / self._relative
        is_interface = self.path.suffix in EXTENSIONS and not self.path.name.startswith(".")
        self._exists = storage.exists(self.path)
        self.is_usable = is_interface and self._exists

    @property
    def depends_on_build(self) -> bool:
        """Whether it has a generator expression, which has no value before everything is configured."""
        return "$<" in self.text

    def problem(self, sources: Iterable[Source]) -> Diagnostic | None:
        """The mistake in this file; `sources` are the files that may name it."""
        doubt = self._call.doubt
        if self.depends_on_build or (doubt is not None and doubt.lost):
            return None
        if not self._exists:
            return Diagnostic(
                "missing-file",
                f"'{shorten(self.text)}' is passed to {GENERATE}, but there is no such file",
                self._label(sources),
                help=_near(self.path) or "write the file, or take it out of the list",
                severity="error" if doubt is None else "warning",
            )
        if self.path.suffix not in EXTENSIONS:
            message = f"'{shorten(self.text)}' is not an interface file: rosidl fails"
            return Diagnostic(
                "no-interface-file",
                message,
                self._label(sources),
                help=f"pass {', '.join(EXTENSIONS)} files only",
                severity="warning",
            )
        if self.text.startswith("/") != self._is_pair or "/" not in self._within:
            message = f"rosidl does not find {shorten(self.path.name)} by this path"
            label = self._label(sources)
            return Diagnostic("unusual-path", message, label, help=self._advice(), severity="warning")
        return None

    def _advice(self) -> str:
        advice = "pass it relative to CMakeLists.txt"
        if "/" not in self._within:
            return f"rosidl requires a folder in the path: move it, for example to msg/{self.path.name}"
        if self._is_pair:
            pair = f"${{CMAKE_CURRENT_SOURCE_DIR}}/{self.text}"
            return f"{advice}, or as an absolute folder, a colon and a path: {pair}"
        return f"{advice}: {self._relative}"

    def _label(self, sources: Iterable[Source]) -> Label:
        """The place of its name if it is written out, else the place of the call."""
        for wanted in (self.text, self.path.name):
            for source in sources:
                at = source.text.find(wanted)
                if at >= 0:
                    return Label(Span(source, at, at + len(wanted)))
        return Label(self._call.span)


def _near(path: Path) -> str | None:
    try:
        names = [entry.name for entry in storage.entries(path.parent) if entry.name.endswith(EXTENSIONS)]
    except (OSError, ValueError):
        return None
    return did_you_mean(path.name, names, form="{}") or None
