"""Lifecycle nodes: one that does as it is told, one that cannot be configured."""

from __future__ import annotations

import rclpy
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.node import Node

from tests.tools.scenes.stage import play


class Stubborn(LifecycleNode):
    """Refuses to be configured."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Fail."""
        return TransitionCallbackReturn.FAILURE


def main() -> None:
    """Wait for transitions."""
    rclpy.init()
    play(LifecycleNode("camera", namespace="/demo"), Stubborn("stubborn"), Node("plain"))


if __name__ == "__main__":
    main()
