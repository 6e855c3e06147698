"""ExecutableInPackage, by upstream's module name."""

from launch_ros.substitutions import ExecutableInPackage

__all__ = ["ExecutableInPackage"]
