"""Definitions that differ on real rclpy: noting our endpoints, looking at the graph, telling, guarding.

Only imported where real rclpy runs: `noting.begin` starts everything, when a class first gets its type
support.
"""
