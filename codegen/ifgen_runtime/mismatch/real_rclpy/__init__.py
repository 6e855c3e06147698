"""Definitions that differ on real rclpy: instrumentation of endpoints, looks at the graph, reports, guards.

Only imported where real rclpy runs: `instrumentation.begin` starts everything, when a class first gets its type
support.
"""
