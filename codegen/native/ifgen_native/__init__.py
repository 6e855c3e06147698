"""A codec and type support for real rclpy in C, one for all message types; `ifgen_runtime` drives it."""
