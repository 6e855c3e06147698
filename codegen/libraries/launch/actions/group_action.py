"""GroupAction, by upstream's module name."""

from launch.actions._groups import GroupAction

__all__ = ["GroupAction"]
