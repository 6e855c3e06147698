"""Walks between obstacles that the robot has to find with its camera."""

from __future__ import annotations

import pytest

pytest.importorskip("rclpy", reason="the graph needs the underlay")

from humanoid.simulation import rendering
