"""The command line in this process. Folders `inside` need our rclpy: test_inside.py runs them in processes of their own."""

from __future__ import annotations

import os

from tests.cli.conftest import cache_folder, clean_environment, ifgen

__all__ = ["cache_folder", "clean_environment", "ifgen"]

collect_ignore_glob = [] if os.environ.get("IFGEN_INSIDE_UNDERLAY") else ["*/inside"]
