"""Two versions of a type, and what the runtime passes on when they meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import ifgen.dynamic
from ifgen_runtime.mismatch.reporting import Definition, Mismatch, Side, definition_of
from ifgen_runtime.type_description import type_name

BATTERY = "robot_msgs/msg/BatteryState"
NEW = """\
uint8 OK=0
uint8 LOW=1
uint8 EMPTY=2

std_msgs/Header header
float32 voltage      # [V]
float32 current      # [A]
float32 charge       # [A.h]
uint8 level          # one of the constants
"""
OLD = """\
uint8 OK=0
uint8 LOW=1

std_msgs/Header header
float32 voltage      # [V]
float32 charge       # [A.h]
uint8 status         # OK or LOW
"""


def made(text: str, name: str = BATTERY, others: Mapping[str, str] | None = None) -> Any:
    """The class of a definition."""
    return ifgen.dynamic.class_from_text(name, text, others=others)


def met(
    theirs: Any,
    mine: Any,
    *,
    kind: str = "topic",
    policy: str = "warn",
    roles: tuple[str, str] = ("publisher", "subscription"),
) -> Mismatch:
    """/driver has `theirs`, and this process, as /monitor, has `mine`."""
    sides = [
        Side(node, role, cls.__type_hash__, definition_of(cls))
        for node, role, cls in zip(("/driver", "/monitor"), roles, (theirs, mine), strict=True)
    ]
    return Mismatch(kind, "/battery", type_name(mine), policy, sides[1], sides[0])


def without_sources(side: Side) -> Side:
    """The same side, which knows no text of its definition."""
    assert side.definition is not None
    return replace(side, definition=Definition(side.definition.document))


def without_definition(mismatch: Mismatch) -> dict[str, Any]:
    """The other side did not send its definition."""
    return asdict(replace(mismatch, theirs=replace(mismatch.theirs, definition=None)))
