"""Type support: what real rclpy hands to the middleware for a class, made when rclpy first asks.

Nothing here is needed, or imported, without real rclpy.
"""

from __future__ import annotations

from typing import Any

from ifgen_runtime.type_support.errors import TypeSupportError


def import_type_support(interface: type[Any]) -> None:
    """Give an interface class, and its parts, the attributes that rclpy looks for on metaclasses.

    Raises TypeSupportError, which says what is missing and what to do.
    """
    from ifgen_runtime.mismatch.real_rclpy import instrumentation  # with rclpy only, and it is running
    from ifgen_runtime.type_support.register import give_type_support  # ctypes, and the libraries of ROS

    try:
        give_type_support(interface)
    except TypeSupportError:
        raise
    except RuntimeError as error:  # the extension has no room for another type
        raise TypeSupportError(f"no type support for {interface.__name__}: {error}") from error
    instrumentation.begin()
