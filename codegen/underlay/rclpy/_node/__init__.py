"""The parts of `rclpy.node.Node`, one concern a module."""
