"""Relative, private and templated topic names."""

from __future__ import annotations

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Return the absolute form of a topic name as the given node would use it, without remapping.

    `~` stands for the node, `{node}`, `{ns}` and `{namespace}` for its parts. Raises ValueError when one of
    the names is invalid or a substitution is unknown.
    """
    return _rclpy.rclpy_expand_topic_name(topic_name, node_name, node_namespace)
