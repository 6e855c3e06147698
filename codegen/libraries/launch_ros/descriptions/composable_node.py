"""ComposableNode, by upstream's module name."""

from launch_ros.descriptions import ComposableNode

__all__ = ["ComposableNode"]
