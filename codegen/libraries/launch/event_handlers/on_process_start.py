"""OnProcessStart, by upstream's module name."""

from launch.event_handlers import OnProcessStart

__all__ = ["OnProcessStart"]
