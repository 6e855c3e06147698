"""PushRosNamespace, by upstream's module name."""

from launch_ros.actions._defaults import PushRosNamespace

__all__ = ["PushRosNamespace"]
