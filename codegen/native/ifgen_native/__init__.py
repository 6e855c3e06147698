"""Type support for real rclpy in C, one for all message types; `ifgen_runtime.type_support` drives it."""
