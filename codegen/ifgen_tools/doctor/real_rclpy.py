"""A program that says which rclpy is the real one here, and whether our classes work on it.

`ifgen doctor` runs it, because importing rclpy fixes the transport of a process, and may end it.
"""

from __future__ import annotations

from importlib.metadata import version

import ifgen
from ifgen_runtime import installation
from ifgen_runtime.real_rclpy.binding import TypeSupportError, native

# Late imports: rclpy is found once the transport has been chosen.


def main() -> None:
    """Print the place of rclpy, its middleware, and `ok` with the version of our extension, or its error."""
    ifgen.activate("rclpy")
    import rclpy
    from rclpy.utilities import get_rmw_implementation_identifier

    print(rclpy.__file__)
    print(get_rmw_implementation_identifier())
    try:
        native()
        print("ok", installation.NATIVE, version(installation.NATIVE))
    except TypeSupportError as error:
        print(error)


if __name__ == "__main__":
    main()
