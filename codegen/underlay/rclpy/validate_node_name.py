"""Checks of node names."""

from __future__ import annotations

from typing import Literal

from rclpy.exceptions import InvalidNodeNameException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def validate_node_name(node_name: str) -> Literal[True]:
    """Return True for a valid node name (no namespace in it); raises InvalidNodeNameException."""
    result = _rclpy.rclpy_get_validation_error_for_node_name(node_name)
    if result is None:
        return True
    raise InvalidNodeNameException(node_name, *result)
