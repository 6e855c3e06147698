"""The files in `inside/` need our rclpy: they are collected in a process of their own, by test_inside.py."""

from __future__ import annotations

import os
from pathlib import Path

collect_ignore = [] if os.environ.get("IFGEN_INSIDE_UNDERLAY") else [str(Path(__file__).parent / "inside")]
