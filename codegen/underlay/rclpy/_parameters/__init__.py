"""Functions about parameters for `rclpy.node.Node`, which do not need a node."""
