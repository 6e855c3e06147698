"""Checks of fully qualified topic and service names."""

from __future__ import annotations

from typing import Literal

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def validate_full_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """Return True for a valid absolute name.

    Raises InvalidTopicNameException, or InvalidServiceNameException if `is_service`.
    """
    result = _rclpy.rclpy_get_validation_error_for_full_topic_name(name)
    if result is None:
        return True
    raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *result)
