"""PathJoinSubstitution, by upstream's module name."""

from launch.substitutions._places import PathJoinSubstitution

__all__ = ["PathJoinSubstitution"]
