"""RegisterEventHandler, by upstream's module name."""

from launch.actions._events import RegisterEventHandler

__all__ = ["RegisterEventHandler"]
