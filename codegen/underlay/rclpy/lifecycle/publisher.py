"""A publisher that is silent unless its node is active."""

from __future__ import annotations

from typing import Any

from rclpy.publisher import MsgType, Publisher

from .managed_entity import SimpleManagedEntity


class LifecyclePublisher(SimpleManagedEntity, Publisher[MsgType]):
    """A publisher that drops messages while it is not activated."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: MsgType | bytes) -> None:
        """Publish a message, or bytes, if activated."""
        Publisher.publish(self, msg)
