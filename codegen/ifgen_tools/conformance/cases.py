"""The cases: read from files, and some of them made from those."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Final

from ifgen import resources
from ifgen.command_kit.tool import ToolError
from ifgen.definition.interfaces import Registry

from ifgen_tools.conformance.canonical import CanonicalText
from ifgen_tools.conformance.testee import Reply

_HUGE: Final = (0xFFFFFFFF, 0x80000000, 0x10000001)
_MOST_CUTS: Final = 150
"""The number of cuts of one payload. A longer payload is cut at its beginning and at its end."""
MEMORY: Final = 256 << 20
"""Bytes that reading a hostile payload may take."""


def folder() -> Path:
    """The folder of the suite: `cases/`, and the definitions that only the suite has, in `interfaces/`."""
    beside = Path(__file__).with_name("suite")
    return beside if beside.is_dir() else resources.PACKAGE.parents[1] / "tests/conformance"


@dataclass(frozen=True, slots=True)
class Case:
    """One request, and the right replies: data, `refused`, or `any` where only a crash is wrong."""

    name: str
    op: str
    type_name: str
    arguments: tuple[str, ...] = ()
    accepted: tuple[str, ...] = ()
    is_hostile: bool = False

    @property
    def group(self) -> str:
        """The first part of its name."""
        return self.name.partition("/")[0]

    def problem(self, reply: Reply) -> str | None:
        """A sentence about a wrong reply; None if it is right."""
        if reply.verdict == "ok":
            wanted = reply.data in self.accepted or "any" in self.accepted
        else:
            wanted = reply.verdict == "refused" and not {"refused", "any"}.isdisjoint(self.accepted)
        if wanted:
            return None
        return f"expected {' or '.join(map(_shortened, self.accepted))}, got {_shortened(reply.text)}"


def _shortened(text: str) -> str:
    return text if len(text) <= 200 else f"{text[:200]}... ({len(text)} characters)"


@cache
def definitions(folder: Path) -> Registry:
    """The definitions that come with ifgen, and those in `interfaces/` of a suite."""
    from ifgen.pipeline.stages import load  # only cases of the wire need them

    own = folder / "interfaces"
    return load(resources.bundled_interfaces(), *([own] if any(own.glob("*/package.xml")) else []))


@dataclass(frozen=True, slots=True)
class Suite:
    """All cases of a folder whose names match one of the patterns; all cases if there is none."""

    folder: Path = field(default_factory=folder)
    only: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[Case]:
        for line in self._lines():
            for case in self._made_of(*line) if self._may_want(line[0]) else ():
                if self._wants(case.name):
                    yield case

    def _lines(self) -> Iterator[list[str]]:
        paths = sorted((self.folder / "cases").glob("*.txt"))
        if not paths:
            raise ToolError(f"there are no cases in {self.folder / 'cases'}")
        for path in paths:
            for line in path.read_text(encoding="ascii").splitlines():
                words = line.split(" ")
                if line and not line.startswith("#"):
                    words[0] = words[0].replace("=", words[2])
                    yield words

    def _wants(self, name: str) -> bool:
        return not self.only or any(fnmatchcase(name, pattern) for pattern in self.only)

    def _may_want(self, name: str) -> bool:
        """Whether a pattern may fit a case that is made from the line of this name."""
        return not self.only or any(
            (fixed := re.split(r"[*?\[]", pattern)[0]).startswith(name) or name.startswith(fixed)
            for pattern in self.only
        )

    def _made_of(self, name: str, kind: str, type_name: str, *rest: str) -> Iterable[Case]:
        match kind:
            case "wire":
                return self._wire(name, type_name, rest[0])
            case "default":
                return [Case(f"{name}:default", "default", type_name, (), rest)]
            case "hostile":
                return self._hostile(name, type_name, rest[0])
            case _:
                *arguments, accepted = rest
                return [Case(f"{name}:{kind}", kind, type_name, tuple(arguments), tuple(accepted.split("|")))]

    def _wire(self, name: str, type_name: str, payload: str) -> Iterator[Case]:
        text = CanonicalText(definitions(self.folder), type_name, bytes.fromhex(payload)).text
        size = str(len(payload) // 2)
        yield Case(f"{name}:recode", "recode", type_name, (payload,), (payload,))
        yield Case(f"{name}:dump", "dump", type_name, (payload,), (text,))
        yield Case(f"{name}:load", "load", type_name, (text,), (payload,))
        yield Case(f"{name}:size", "size", type_name, (payload,), (size,))

    def _hostile(self, name: str, type_name: str, payload: str) -> Iterator[Case]:
        """Every cut of a payload; counts and lengths that do not fit; bytes after the message."""
        data = bytes.fromhex(payload)
        half = _MOST_CUTS // 2
        for size in range(len(data)):
            if size < half or size >= len(data) - half:
                cut = payload[: 2 * size] or "-"
                yield Case(f"{name}/cut/{size}:recode", "recode", type_name, (cut,), ("refused",), True)
        for place in CanonicalText(definitions(self.folder), type_name, data).counts:
            for count in _HUGE:
                changed = data[:place] + struct.pack("<I", count) + data[place + 4 :]
                at = f"{name}/count/{place}/{count:x}:recode"
                yield Case(at, "recode", type_name, (changed.hex(),), ("refused",), True)
        for size in (1, 3, 8):
            longer = payload + "a5" * size
            yield Case(f"{name}/trailing/{size}:recode", "recode", type_name, (longer,), (payload,), True)
        for kind in (2, 3, 6, 7, 8, 9, 10, 11, 255):
            other = f"00{kind:02x}0000{payload[8:]}"
            yield Case(f"{name}/header/{kind}:recode", "recode", type_name, (other,), ("any",), True)
