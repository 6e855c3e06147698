"""Parts of interfaces that the target ROS 2 does not support."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final, Literal

from ifgen.diagnostics import Diagnostic

RosDistro = Literal["humble", "iron", "jazzy", "kilted", "lyrical", "rolling"]

_OPTIONAL: Final = "optional-field"
_WITHOUT_OPTIONAL: Final = frozenset(("humble", "iron", "jazzy", "kilted"))


def is_old(ros_distro: str | None) -> bool:
    """Whether rosidl of a distribution refuses what newer ones read. One that is unknown counts as new."""
    return ros_distro in _WITHOUT_OPTIONAL


def judged(found: Iterable[Diagnostic], ros_distro: str | None) -> list[Diagnostic]:
    """The findings, where those are errors that the rosidl of a distribution makes errors of."""
    if not is_old(ros_distro):
        return list(found)
    name = str(ros_distro).capitalize()
    message = f"ROS 2 {name} does not know `@optional`"
    advice = (
        'remove it: it came with Lyrical. If that is your ROS 2, set `ros_distro = "lyrical"` in [tool.ifgen]'
    )
    return [
        replace(d, message=message, help=advice, severity="error") if d.rule == _OPTIONAL else d
        for d in found
    ]


def refused(found: Iterable[Diagnostic], ros_distro: str | None) -> list[Diagnostic]:
    """Those of the warnings that are errors for a distribution."""
    return [d for d in judged(found, ros_distro) if d.severity == "error"]
