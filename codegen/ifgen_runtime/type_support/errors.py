"""Errors before a never-compiled class works on real rclpy."""


class TypeSupportError(RuntimeError):
    """Real rclpy cannot be given type support for our classes here; the text says why and what to do."""
