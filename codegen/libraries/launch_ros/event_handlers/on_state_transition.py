"""OnStateTransition, by upstream's module name."""

from launch_ros.event_handlers import OnStateTransition

__all__ = ["OnStateTransition"]
