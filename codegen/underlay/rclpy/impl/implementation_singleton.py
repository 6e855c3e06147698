"""The one name under which rclpy's modules reach what upstream keeps in C."""

from __future__ import annotations

from rclpy import _rclpy_pybind11 as rclpy_implementation

__all__ = ["package", "rclpy_implementation"]

package = "rclpy"
