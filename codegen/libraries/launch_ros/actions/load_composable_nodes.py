"""LoadComposableNodes, by upstream's module name."""

from launch_ros.actions.composable_node_container import LoadComposableNodes

__all__ = ["LoadComposableNodes"]
