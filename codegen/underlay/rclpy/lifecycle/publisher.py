"""A publisher that is silent unless its node is active."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.impl import typed
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import MessageT
from rclpy.publisher import MsgType as MsgType  # noqa: PLC0414 - programs import it from here
from rclpy.publisher import Publisher

from .managed_entity import SimpleManagedEntity

if TYPE_CHECKING:
    _PublisherOf = Publisher
else:
    _PublisherOf = typed.PlainBase(Publisher)
    __getattr__ = reexport(__name__)


class LifecyclePublisher(SimpleManagedEntity, _PublisherOf[MessageT]):
    """A publisher that drops messages while it is not activated."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: MessageT | bytes) -> None:
        """Publish a message, or bytes, if activated."""
        Publisher.publish(self, msg)
