"""The source of most chains of filters."""

from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from message_filters.simple_filter import SimpleFilter


class Subscriber(SimpleFilter):
    """Passes on the messages of a topic.

    `kwargs` are those of `Node.create_subscription`, such as `callback_group`. Attributes that a filter lacks
    are those of the subscription.
    """

    def __init__(
        self,
        node: Node,
        msg_type: type[Any],
        topic: str,
        qos_profile: QoSProfile | int = QoSProfile(depth=10),  # noqa: B008 - upstream's default; nobody changes it
        **kwargs: Any,
    ) -> None:
        super().__init__()
        self.node = node
        self.topic = topic
        self.sub = node.create_subscription(
            msg_type=msg_type, topic=topic, callback=self.callback, qos_profile=qos_profile, **kwargs
        )

    def callback(self, msg: Any) -> None:
        """Pass on a message of the topic."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the name of the topic, as it was given."""
        return self.topic

    def __getattr__(self, key: str) -> Any:
        if key == "sub":  # not yet there, or never, if the subscription failed
            raise AttributeError(f"'{type(self).__name__}' object has no attribute 'sub'")
        return getattr(self.sub, key)
