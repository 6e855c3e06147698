"""The former name of `rclpy.event_handler`."""

from __future__ import annotations

import warnings

from rclpy.event_handler import *  # noqa: F403
from rclpy.impl import distro as _distro

if _distro.follows("old_names"):
    _TEXT = "No module named 'rclpy.qos_event': ROS 2 Lyrical has removed it, use rclpy.event_handler"
    raise ModuleNotFoundError(_TEXT, name=__name__)

warnings.warn("importing 'qos_event' is deprecated; import 'event_handler' instead", stacklevel=2)
