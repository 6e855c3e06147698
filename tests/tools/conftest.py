"""The command line in this process."""

from __future__ import annotations

from tests.cli.conftest import cache_folder, clean_environment, ifgen

__all__ = ["cache_folder", "clean_environment", "ifgen"]
