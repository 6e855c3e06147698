"""`on_type_mismatch`: what a node does if somebody has another definition of a type that it uses."""

from __future__ import annotations

import os
from enum import StrEnum
from typing import Any, Final

NAME: Final = "on_type_mismatch"
"""The parameter, and the attribute of a node's class."""

VARIABLE: Final = "IFGEN_ON_TYPE_MISMATCH"
"""The environment variable."""


class OnTypeMismatch(StrEnum):
    """A policy."""

    WARN = "warn"
    """Say it once; messages still flow, as in ROS."""
    REFUSE = "refuse"
    """Deliver nothing while somebody with another definition is there."""
    ADAPT = "adapt"
    """Convert by a registered adapter (`ifgen_runtime.adapters`); without one, refuse."""


def policy_of(node: Any, override: object = None) -> OnTypeMismatch:
    """The policy of a node, from its parameter (`override`), else its class, else the environment.

    Without any, it is to warn. A method of this name is none: a node may call back so. Raises ValueError, in
    one sentence, for a value that is none of the three.
    """
    attribute = getattr(node, NAME, None)
    for value, place in (
        (override, f"parameter {NAME}"),
        (None if callable(attribute) else attribute, f"{type(node).__name__}.{NAME}"),
        (os.environ.get(VARIABLE) or None, VARIABLE),
    ):
        if value is not None:
            return _policy(value, place)
    return OnTypeMismatch.WARN


def _policy(value: object, place: str) -> OnTypeMismatch:
    try:
        return OnTypeMismatch(str(value))
    except ValueError:
        known = ", ".join(policy.value for policy in OnTypeMismatch)
        raise ValueError(f"{place} is {value!r}, expected one of {known}") from None
