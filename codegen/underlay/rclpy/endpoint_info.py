"""Information of the graph about endpoints, in one module, as newer ROS has it."""

from __future__ import annotations

from rclpy.impl import distro
from rclpy.impl.newer import EndpointTypeEnum, ServiceEndpointInfo
from rclpy.impl.topic_endpoint_info import TopicEndpointInfo

__all__ = ["EndpointTypeEnum", "ServiceEndpointInfo", "TopicEndpointInfo"]

distro.uses("endpoint_info")
