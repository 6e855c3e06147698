"""Shutdown, by upstream's module name."""

from launch.events import Shutdown

__all__ = ["Shutdown"]
