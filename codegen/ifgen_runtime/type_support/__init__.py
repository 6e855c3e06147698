"""Type support: what real rclpy hands to the middleware for a class, made when rclpy first asks.

Nothing here is needed, or imported, without real rclpy.
"""

from __future__ import annotations

from typing import Any


def import_type_support(interface: type[Any]) -> None:
    """Give a message, service or action class, and its parts, the attributes that rclpy looks for on metaclasses.

    Raises TypeSupportError, which says what is missing and what to do.
    """
    from ifgen_runtime.type_support.register import give_type_support  # ctypes, and the libraries of ROS

    give_type_support(interface)
