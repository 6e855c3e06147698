"""TimerAction, by upstream's module name."""

from launch.actions._events import TimerAction

__all__ = ["TimerAction"]
