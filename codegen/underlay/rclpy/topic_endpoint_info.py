"""Information of the graph about one publisher or subscription, where ROS before Lyrical has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl import distro as _distro
from rclpy.impl.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum

if not TYPE_CHECKING:
    from rclpy.impl.reexports import reexport

    __getattr__ = reexport(__name__)

__all__ = ["TopicEndpointInfo", "TopicEndpointTypeEnum"]

if _distro.follows("old_names"):
    raise ModuleNotFoundError(f"No module named {__name__!r}: use rclpy.endpoint_info", name=__name__)
