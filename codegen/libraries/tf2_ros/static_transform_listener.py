"""Keeps a buffer up to date with `/tf_static`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tf2_ros.transform_listener import DEFAULT_STATIC_TF_TOPIC, TransformListener

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from tf2_py import BufferCore


class StaticTransformListener(TransformListener):
    """Stores the static transforms that arrive in a buffer. ROS 2 Kilted added it.

    The parameters are those of `TransformListener`.
    """

    def __init__(
        self,
        buffer: BufferCore,
        node: Node | None,
        *,
        spin_thread: bool = False,
        static_qos: QoSProfile | int | None = None,
        tf_static_topic: str = DEFAULT_STATIC_TF_TOPIC,
    ) -> None:
        super().__init__(
            buffer,
            node,
            spin_thread=spin_thread,
            static_qos=static_qos,
            tf_static_topic=tf_static_topic,
            static_only=True,
        )
