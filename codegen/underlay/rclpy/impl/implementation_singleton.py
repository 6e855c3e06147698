"""The one name under which rclpy's modules reach what upstream keeps in C."""

from __future__ import annotations

from rclpy.impl import rcl as rclpy_implementation

__all__ = ["package", "rclpy_implementation"]

package = "rclpy"
