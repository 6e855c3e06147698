"""The way of both programs: a robot from a file, and a node that is spun until it is stopped."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from robot_state_publisher.urdf import UrdfError


def run(name: str, make: Callable[[str], Node], args: Sequence[str] | None, advice: str = "") -> int:
    """Spin the node that `make` returns for the text of the file in `args`, if there is one.

    Exits with a sentence if the file cannot be read, or describes no robot; `advice` follows that.
    """
    words = remove_ros_args(list(sys.argv if args is None else args))[1:]
    try:
        text = Path(words[0]).read_text(encoding="utf-8") if words else ""
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{name}: cannot read '{words[0]}': {error}")
    rclpy.init(args=sys.argv if args is None else list(args))
    try:
        rclpy.spin(make(text))
    except UrdfError as error:
        sys.exit(f"{name}: {error}{advice}")
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0
