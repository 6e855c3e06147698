"""FindExecutable, by upstream's module name."""

from launch.substitutions._places import FindExecutable

__all__ = ["FindExecutable"]
