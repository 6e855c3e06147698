"""All that real rclpy needs: type support of our classes, and a look at who has other definitions of them.

Nothing here is imported without real rclpy. It begins when rclpy first asks a class for its type support.
"""

from __future__ import annotations

from typing import Any

from ifgen_runtime.real_rclpy.binding import TypeSupportError


def import_type_support(interface: type[Any]) -> None:
    """Give an interface class, and its parts, the attributes that rclpy looks for on metaclasses.

    Raises TypeSupportError, which says what is missing and what to do.
    """
    from ifgen_runtime.real_rclpy import instrumentation  # with rclpy only, and it is running
    from ifgen_runtime.real_rclpy.register import give_type_support  # with the extension, if it is there

    try:
        give_type_support(interface)
    except TypeSupportError:
        raise
    except RuntimeError as error:  # the extension has no room for another type
        raise TypeSupportError(f"no type support for {interface.__name__}: {error}") from error
    instrumentation.begin()
