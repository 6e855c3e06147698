"""OnProcessExit, by upstream's module name."""

from launch.event_handlers import OnProcessExit

__all__ = ["OnProcessExit"]
