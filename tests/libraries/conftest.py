"""The files in `inside/` need one rclpy or the other: test_inside.py collects them in processes of their own."""

from __future__ import annotations

import os
from pathlib import Path

collect_ignore = [] if os.environ.get("IFGEN_INSIDE_TRANSPORT") else [str(Path(__file__).parent / "inside")]
