"""Publishes what nodl_observe would publish of a node, for late subscriptions."""

import rclpy
from ifgen_tools.nodl import observation

rclpy.init()
node = rclpy.create_node("observer")
cls = observation.message_class("Node")
publisher = node.create_publisher(cls, observation.TOPIC, observation.latched())
publisher.publish(cls(name="/seen"))
rclpy.spin(node)
