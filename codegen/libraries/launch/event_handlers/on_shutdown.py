"""OnShutdown, by upstream's module name."""

from launch.event_handlers import OnShutdown

__all__ = ["OnShutdown"]
