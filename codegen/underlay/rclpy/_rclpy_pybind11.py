"""Upstream's extension module under its own name, for programs that import errors and handles from there."""

from __future__ import annotations

from rclpy.impl.rcl import *  # noqa: F403
