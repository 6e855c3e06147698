"""matches_action, by upstream's module name."""

from launch.events import matches_action

__all__ = ["matches_action"]
