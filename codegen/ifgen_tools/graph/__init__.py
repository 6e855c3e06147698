"""The graph of who talks to whom, as rclpy sees it, and `ifgen graph`, which draws it."""
