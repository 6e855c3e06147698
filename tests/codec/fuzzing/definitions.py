"""Packages of random message definitions."""

from __future__ import annotations

from pathlib import Path
from random import Random

_BASIC = (
    *("bool", "byte", "char", "int8", "uint8", "int16", "uint16"),
    *("int32", "uint32", "int64", "uint64", "float32", "float64"),
)
_KNOWN = ("std_msgs/Header", "geometry_msgs/Pose", "builtin_interfaces/Time", "sensor_msgs/JointState")
_LARGE = 150  # fields; more than the generated code handles in one function


def write_package(folder: Path, seed: int, count: int = 40) -> Path:
    """A package `fuzz_msgs` of `count` messages in the folder; later messages nest earlier ones."""
    rng = Random(seed)
    home = folder / "fuzz_msgs" / "msg"
    home.mkdir(parents=True)
    for number in range(count):
        most = _LARGE if number % 20 == 19 else 9
        fields = rng.randrange(most // 2, most + 1) if number else 0
        lines = [f"{_field_type(rng, number)} f{index}\n" for index in range(fields)]
        (home / f"M{number}.msg").write_text("".join(lines))
    return home.parent


def _field_type(rng: Random, earlier: int) -> str:
    return _element_type(rng, earlier) + _shape(rng)


def _element_type(rng: Random, earlier: int) -> str:
    kind = rng.random()
    if kind < 0.55:
        return rng.choice(_BASIC)
    if kind < 0.75:
        bound = rng.choice(["", "", f"<={rng.randrange(1, 9)}"])
        return rng.choice(["string", "string", "wstring"]) + bound
    if kind < 0.85 or earlier % 20 == 19:
        return rng.choice(_KNOWN)
    return f"M{rng.randrange(max(earlier - 12, 0), earlier)}" if earlier else "int32"


def _shape(rng: Random) -> str:
    kind = rng.random()
    if kind < 0.5:
        return ""
    if kind < 0.7:
        return "[]"
    return f"[{rng.randrange(1, 5)}]" if kind < 0.85 else f"[<={rng.randrange(1, 5)}]"
