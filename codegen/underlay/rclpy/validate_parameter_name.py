"""Checks of parameter names."""

from __future__ import annotations

from typing import Literal

from rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> Literal[True]:
    """Return True for a valid parameter name, which is any but the empty one.

    Raises InvalidParameterException.
    """
    if not name:
        raise InvalidParameterException(name)
    return True
