"""A pytest plugin for tests of programs that use rclpy; docs/testing.md. Does nothing until it is asked."""
