"""Keeps a buffer up to date with `/tf` and `/tf_static`."""

from __future__ import annotations

from threading import Thread, current_thread
from typing import TYPE_CHECKING

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

if TYPE_CHECKING:
    from tf2_py import BufferCore

DEFAULT_TF_TOPIC = "/tf"
DEFAULT_STATIC_TF_TOPIC = "/tf_static"

# Nobody asks who sent a message.
_AUTHORITY = "default_authority"


class TransformListener:
    """Stores the transforms that arrive in a buffer.

    :param buffer: where to.
    :param node: subscribes; a node of its own if None.
    :param spin_thread: whether to spin the node in a thread of its own.
    :param qos: a profile or a depth for `/tf`; volatile, a depth of 100, if None.
    :param static_qos: the same for `/tf_static`; transient local, a depth of 100, if None.
    :param tf_topic: the topic of transforms that change.
    :param tf_static_topic: the topic of static ones.
    :param static_only: whether to listen to static ones only.
    """

    def __init__(
        self,
        buffer: BufferCore,
        node: Node | None,
        *,
        spin_thread: bool = False,
        qos: QoSProfile | int | None = None,
        static_qos: QoSProfile | int | None = None,
        tf_topic: str = DEFAULT_TF_TOPIC,
        tf_static_topic: str = DEFAULT_STATIC_TF_TOPIC,
        static_only: bool = False,
    ) -> None:
        self.buffer = buffer
        self.node = _own_node(self) if node is None else node
        # Waiting for a transform in a callback must not keep transforms out.
        self.group = ReentrantCallbackGroup()
        if not static_only:
            self.tf_sub = self.node.create_subscription(
                TFMessage,
                tf_topic,
                self.callback,
                _profile(DurabilityPolicy.VOLATILE) if qos is None else qos,
                callback_group=self.group,
            )
        self.tf_static_sub = self.node.create_subscription(
            TFMessage,
            tf_static_topic,
            self.static_callback,
            _profile(DurabilityPolicy.TRANSIENT_LOCAL) if static_qos is None else static_qos,
            callback_group=self.group,
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor(context=self.node.context)
            self.dedicated_listener_thread = Thread(target=_spin, args=(self.executor, self.node))
            self.dedicated_listener_thread.start()

    def __del__(self) -> None:
        thread = getattr(self, "dedicated_listener_thread", None)
        # A collector may run on that thread, too.
        if thread is not None and thread.is_alive() and thread is not current_thread():
            self.executor.shutdown()
            thread.join()
        if hasattr(self, "tf_static_sub"):  # else __init__ failed
            self.unregister()

    def unregister(self) -> None:
        """Listen no more."""
        if hasattr(self, "tf_sub"):
            self.node.destroy_subscription(self.tf_sub)
        self.node.destroy_subscription(self.tf_static_sub)

    def callback(self, data: TFMessage) -> None:
        """Store transforms that change."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, _AUTHORITY)

    def static_callback(self, data: TFMessage) -> None:
        """Store static transforms."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, _AUTHORITY)


def _profile(durability: DurabilityPolicy) -> QoSProfile:
    return QoSProfile(depth=100, durability=durability, history=HistoryPolicy.KEEP_LAST)


def _own_node(listener: TransformListener) -> Node:
    return Node(
        f"transform_listener_impl_{id(listener):010x}",
        enable_rosout=False,
        start_parameter_services=False,
        parameter_overrides=[Parameter("use_sim_time", value=False)],
    )


def _spin(executor: SingleThreadedExecutor, node: Node) -> None:
    executor.add_node(node)
    try:
        executor.spin()
    except ExternalShutdownException:
        pass
    finally:
        executor.remove_node(node)
