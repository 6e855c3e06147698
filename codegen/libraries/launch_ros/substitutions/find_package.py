"""FindPackage and its kin, by upstream's module name."""

from launch_ros.substitutions import FindPackage, FindPackagePrefix, FindPackageShare

__all__ = ["FindPackage", "FindPackagePrefix", "FindPackageShare"]
