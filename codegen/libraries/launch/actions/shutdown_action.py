"""Shutdown, by upstream's module name."""

from launch.actions._events import Shutdown

__all__ = ["Shutdown"]
