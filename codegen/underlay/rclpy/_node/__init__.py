"""What `rclpy.node.Node` works out about parameters, in functions that know no node."""
