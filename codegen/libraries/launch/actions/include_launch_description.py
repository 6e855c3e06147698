"""IncludeLaunchDescription, by upstream's module name."""

from launch.actions._groups import IncludeLaunchDescription

__all__ = ["IncludeLaunchDescription"]
