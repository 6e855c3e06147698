"""A user's managed node."""

from __future__ import annotations

from rclpy.lifecycle import LifecycleNode, LifecyclePublisher, LifecycleState, TransitionCallbackReturn
from std_msgs.msg import Bool, String


class Lamp(LifecycleNode):
    """Tells whether it shines."""

    light: LifecyclePublisher[Bool]

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.light = self.create_lifecycle_publisher(Bool, "light", 1)
        self.create_lifecycle_publisher(Bool, "light", "1")  # refused: arg-type, reportArgumentType
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        answer = super().on_activate(state)
        self.light.publish(Bool(data=True))
        self.light.publish(String(data="on"))  # refused: arg-type, reportArgumentType
        print(state.name)  # refused: attr-defined, reportAttributeAccessIssue
        return answer
