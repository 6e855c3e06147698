"""The files in `inside/` need our rclpy: they are collected in a process of their own, by test_inside.py."""

from __future__ import annotations

import os
from pathlib import Path

from hypothesis import HealthCheck, settings

# A machine that is busy with something else is slow, but not wrong.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")

collect_ignore = [] if os.environ.get("IFGEN_INSIDE_UNDERLAY") else [str(Path(__file__).parent / "inside")]
