"""Every message that nodes of this process publish, on either transport."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any
from weakref import WeakKeyDictionary

Heard = Callable[[str, Any, Any, int], None]
"""Takes the full topic, the publisher, the message or its bytes, and the time [ns since 1970]."""


@contextmanager
def publications(heard: Heard) -> Generator[None]:
    """Call a function for each message that a publisher sends while the block runs, subscribed to or not.

    There is no subscription that could miss what a constructor publishes, and nothing to match or to spin.
    What rclpy sends by itself is not heard: /rosout, and the hidden topics of actions and services.
    """
    publisher_class = importlib.import_module("rclpy.publisher").Publisher  # that of the chosen transport
    clock = importlib.import_module("rclpy.clock").Clock()
    publish = publisher_class.publish
    topics: WeakKeyDictionary[Any, str] = WeakKeyDictionary()

    def publish_and_tell(publisher: Any, message: Any) -> None:
        now = clock.now().nanoseconds  # before: another thread may answer at once
        publish(publisher, message)
        topic = topics.get(publisher)
        if topic is None:
            topic = topics[publisher] = publisher.topic_name
        heard(topic, publisher, message, now)

    publisher_class.publish = publish_and_tell
    try:
        yield
    finally:
        publisher_class.publish = publish
