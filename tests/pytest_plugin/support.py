"""Helpers of the tests of the plugin."""

from __future__ import annotations

import importlib.util

import pytest

needs_rclpy = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None, reason="the real rclpy is not installed (Linux x86_64 only)"
)
