"""Errors and warnings about recordings."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from ifgen_runtime.errors import printable_lines

UNPACKS: Final = "more than ifgen reads of a file of this size without `unlimited`"
"""The end of the reason why a file is not read that unpacks to far more than its size."""

_MOST: Final = 1000
"""Places of damage that are listed."""


class _Said(Exception):
    """A text about a file, without what could steer the terminal of whoever prints it."""

    def __init__(self, text: str = "") -> None:
        super().__init__(printable_lines(text))


class BagError(_Said):
    """A recording cannot be read, written, or understood: where, what was expected, what to do."""


class BagWarning(_Said, UserWarning):
    """A part of a recording was left out, or is doubtful."""


@dataclass(frozen=True, slots=True)
class Damage:
    """A place in a file that could not be read."""

    path: Path
    """The file."""
    offset: int | None
    """The byte where the damage was found; None where that is not known, as in a database."""
    text: str
    """The problem there."""

    def __str__(self) -> str:
        place = "" if self.offset is None else f" at byte {self.offset:,}"
        return f"{self.path}: damaged{place}: {self.text}"


class Damages:
    """The damage that was met in a recording: said once each, or raised where reading is strict."""

    def __init__(self, strict: bool, unlimited: bool = False) -> None:
        self.strict, self.unlimited = strict, unlimited
        self._found: dict[Damage, None] = {}

    @property
    def found(self) -> tuple[Damage, ...]:
        """The damage that was met so far."""
        return tuple(self._found)

    def most_unpacked(self, size: int) -> int:
        """The bytes that we let a file of `size` bytes unpack to, unless whoever asks trusts it."""
        return 2**63 if self.unlimited else 2**25 + 32 * size

    def note(self, path: Path, offset: int | None, text: str) -> None:
        """Raise BagError if reading is strict; otherwise warn, once for each place."""
        damage = Damage(path, offset, printable_lines(text))
        if self.strict:
            raise BagError(str(damage))
        if damage in self._found or len(self._found) > _MOST:
            return
        if len(self._found) == _MOST:
            damage = Damage(path, None, "there is more damage, which is not listed")
        self._found[damage] = None
        warn(str(damage))


def warn(text: str) -> None:
    """Warn, and name the line outside this package that wanted the recording."""
    from inspect import currentframe  # takes long to load, and most recordings are sound

    level, frame = 1, currentframe()
    while frame is not None and _is_ours(frame.f_globals):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, BagWarning, stacklevel=level)


def _is_ours(names: dict[str, Any]) -> bool:
    return str(names.get("__name__", "")).startswith(f"{__package__}.")


def need(module: str, purpose: str) -> Any:
    """A module of the extra `tools`, or pandas. Raises BagError that says how to install it."""
    try:
        return import_module(module)
    except ImportError:
        library = module.partition(".")[0]
        from ifgen_runtime.installation import add_extra  # takes long to load, and only an error needs it

        command = "pip install pandas" if library == "pandas" else add_extra("tools")
        text = f"{purpose} needs the library {library}: {command}"
        raise BagError(text) from None
