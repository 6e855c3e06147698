"""The joint map of somebody else's robot: YAML, checked entry by entry."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import yaml

from . import table
from .model import SoleGeometry
from .table import ModelError

_KEYS = ("base", "torso", "sole", "joints", "frames")
_SOLE_KEYS = ("centre", "length", "width")
_FRAME_KEYS = ("body", "xyz", "rpy")
REQUIRED_JOINTS = tuple(table.JOINT_NAMES[: table.LEGS[1].stop])
"""The joints that every robot must have: two legs of six joints."""
KNOWN_JOINTS = (
    *table.JOINT_NAMES[: table.ARMS[0].start],
    *(f"{side}_{name}" for side in table.SIDES for name in (*table.ARM_JOINTS, table.SEVENTH)),
)
"""The joints that have a meaning for us, in the order of every array over joints."""
_FRAMES = (*(frame.name for frame in table.FRAMES), "l_ankle", "r_ankle")


@dataclass(frozen=True, slots=True)
class Frame:
    """A place in a body: position in metres, angles about x, then y, then z of the body."""

    body: str
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class JointMap:
    """The names of joints and frames; those that are left out have our names."""

    base: str = "base_link"
    torso: str = ""  # torso, or the base if there is no such body
    sole: SoleGeometry | None = None
    joints: Mapping[str, str] = field(default_factory=dict)
    frames: Mapping[str, str | Frame] = field(default_factory=dict)


def read_map(path: Path) -> JointMap:
    """Read a joint map. Raises ModelError, which names the entry that is wrong."""
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ModelError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ModelError(f"{path}: this is not UTF-8 text") from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else str(path)
        raise ModelError(f"{where}: {error.problem}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ModelError(f"{path}: this is not YAML: {str(error).splitlines()[0]}") from error
    return _Reader(path).map(document)


@dataclass(frozen=True, slots=True)
class _Reader:
    path: Path

    def map(self, document: Any) -> JointMap:
        entries = self._mapping(document, "the file", _KEYS)
        joints = self._mapping(entries.get("joints", {}), "joints", KNOWN_JOINTS)
        names = {ours: self._name(theirs, f"joints.{ours}") for ours, theirs in joints.items()}
        taken: dict[str, str] = {}
        for ours in KNOWN_JOINTS:
            theirs = names.get(ours, ours)
            if theirs in taken:
                self._fail(f"joints.{ours}", f"'{theirs}' is already used for '{taken[theirs]}'")
            taken[theirs] = ours
        frames = self._mapping(entries.get("frames", {}), "frames", _FRAMES)
        return JointMap(
            self._name(entries.get("base", "base_link"), "base"),
            self._name(entries["torso"], "torso") if "torso" in entries else "",
            self._sole(entries["sole"]) if "sole" in entries else None,
            names,
            {ours: self._frame(place, f"frames.{ours}") for ours, place in frames.items()},
        )

    def _sole(self, value: Any) -> SoleGeometry:
        entries = self._mapping(value, "sole", _SOLE_KEYS)
        for key in _SOLE_KEYS:
            if key not in entries:
                self._fail("sole", f"'{key}' is missing")
        centre, length, width = (self._number(entries[key], f"sole.{key}") for key in _SOLE_KEYS)
        if min(length, width) <= 0.04:
            self._fail("sole", "length and width must be above 0.04 m")
        return SoleGeometry(centre, length / 2, width / 2)

    def _frame(self, value: Any, where: str) -> str | Frame:
        if isinstance(value, str):
            return self._name(value, where)
        entries = self._mapping(value, where, _FRAME_KEYS)
        if "body" not in entries:
            self._fail(where, "expected the name of a site, or a mapping with 'body'")
        body = self._name(entries["body"], f"{where}.body")
        xyz, rpy = (self._vector(entries.get(key, (0, 0, 0)), f"{where}.{key}") for key in ("xyz", "rpy"))
        return Frame(body, xyz, rpy)

    def _mapping(self, value: Any, where: str, keys: Iterable[str]) -> Mapping[str, Any]:
        """A mapping that has only these keys."""
        if not isinstance(value, dict):
            self._fail(where, f"expected a mapping, got {_kind(value)}")
        for key in value:
            if key not in keys:
                close = difflib.get_close_matches(str(key), list(keys), n=1)
                guess = f"; did you mean '{close[0]}'?" if close else ""
                self._fail(where, f"unknown entry '{key}'{guess}")
        return value

    def _name(self, value: Any, where: str) -> str:
        if not isinstance(value, str) or not value:
            self._fail(where, f"expected a name, got {_kind(value)}")
        return value

    def _number(self, value: Any, where: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            self._fail(where, f"expected a number, got {_kind(value)}")
        return float(value)

    def _vector(self, value: Any, where: str) -> tuple[float, float, float]:
        if not isinstance(value, list | tuple) or len(value) != 3:
            self._fail(where, f"expected three numbers, got {_kind(value)}")
        x, y, z = (self._number(part, where) for part in value)
        return x, y, z

    def _fail(self, where: str, what: str) -> NoReturn:
        raise ModelError(f"{self.path}: {where}: {what}")


def _kind(value: Any) -> str:
    kinds = {dict: "a mapping", list: "a list", str: f"'{value}'", type(None): "nothing"}
    return kinds.get(type(value), f"'{value}'")
