"""Sends transforms that hold at all times."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy
from typing import TYPE_CHECKING

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import as_list

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node


class StaticTransformBroadcaster:
    """Publishes transforms on `/tf_static`, where those who subscribe later get them as well.

    Each message has all transforms so far, because only the last message is kept for them.

    :param node: publishes them.
    :param qos: a profile or a depth; the last message, transient local, if None.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        if qos is None:
            qos = QoSProfile(
                depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=HistoryPolicy.KEEP_LAST
            )
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        self._by_child: dict[str, TransformStamped] = {}

    def sendTransform(self, transform: TransformStamped | Iterable[TransformStamped]) -> None:
        """Publish a transform, or several; each replaces the one before of its child frame."""
        for one in as_list(transform):
            # A copy: programs fill one message again and again.
            self._by_child[one.child_frame_id] = deepcopy(one)
        self.pub_tf.publish(TFMessage(transforms=list(self._by_child.values())))
