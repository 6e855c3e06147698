"""Who talks to whom: the graph as rclpy sees it, and `ifgen graph`, which draws it."""
