"""Checks of namespaces."""

from __future__ import annotations

from typing import Literal

from rclpy.exceptions import InvalidNamespaceException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def validate_namespace(namespace: str) -> Literal[True]:
    """Return True for a valid, absolute namespace; raises InvalidNamespaceException."""
    result = _rclpy.rclpy_get_validation_error_for_namespace(namespace)
    if result is None:
        return True
    raise InvalidNamespaceException(namespace, *result)
