"""EmitEvent, by upstream's module name."""

from launch.actions._events import EmitEvent

__all__ = ["EmitEvent"]
