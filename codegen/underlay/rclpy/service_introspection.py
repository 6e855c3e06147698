"""The contents of a service's events."""

from __future__ import annotations

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

ServiceIntrospectionState = _rclpy.service_introspection.ServiceIntrospectionState
