"""LogInfo, by upstream's module name."""

from launch.actions._events import LogInfo

__all__ = ["LogInfo"]
