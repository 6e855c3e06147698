"""OnActionEventBase, by upstream's module name."""

from launch.event_handlers import OnActionEventBase

__all__ = ["OnActionEventBase"]
