"""Processes that end at the same moment, as by Ctrl-C of a terminal: none waits for another, none aborts."""

from __future__ import annotations

import threading
import time
import weakref

from rclpy.node import Node
from std_msgs.msg import Float64

from tests.rclpy.inside.contract.processes import DURABLE, connected

SOON = 5.0  # [s]; Zenoh gives up after 10


def test_no_process_waits_while_others_leave() -> None:
    """What undeclares a durable publisher holds the interpreter, which others need who see a peer leave."""
    with connected("zenoh") as pair:
        one = pair.process("one")
        others = [pair.process(f"other_{number}") for number in range(4)]
        for other in others:
            for number in range(15):
                other.node.create_publisher(Float64, f"value_{number}", 1)
        publishers = [one.node.create_publisher(Float64, f"state_{number}", DURABLE) for number in range(20)]
        pair.until(lambda: one.node.count_publishers("value_14") == len(others))
        leaving = [threading.Thread(target=other.leave) for other in others]
        begun = time.monotonic()
        for thread in leaving:
            thread.start()
        for publisher in publishers:
            one.node.destroy_publisher(publisher)
        for thread in leaving:
            thread.join()
        assert time.monotonic() - begun < SOON


def test_nothing_of_a_process_is_left_when_it_has_ended() -> None:
    """A thread of ours, or of Zenoh's, that held the last reference would abort Python when that ends."""
    with connected("zenoh") as pair:
        one = pair.process("one")
        other = pair.process("other")
        one.node.create_subscription(Float64, "value", print, 1)
        pair.until(lambda: _hears(other.node))
        transport = weakref.ref(other.link._transport)
        gate = transport()._gate  # type: ignore[union-attr]
        one.leave()  # which `other` notices on a thread of its own, and buries
        pair.until(lambda: not _hears(other.node))
        other.leave()
        assert not gate._inside
        assert not len(gate._callbacks)
        assert not transport()._background._running  # type: ignore[union-attr]


def _hears(node: Node) -> int:
    return node.count_subscribers("value")
