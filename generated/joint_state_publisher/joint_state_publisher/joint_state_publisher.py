"""The node joint_state_publisher: what all joint drivers measure, in one message."""

from __future__ import annotations

from typing import Any

import numpy as np
from humanoid.data import SECOND
from humanoid.robot.body import load_body
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.running import run
from humanoid.sensing.joints import JointCollector
from sensor_msgs.msg import JointState

from joint_state_publisher._joint_state_publisher_base import JointStatePublisherBase
from joint_state_publisher._joint_state_publisher_parameters import ParametersError


class JointStatePublisher(JointStatePublisherBase):
    """Publishes the states of all joints each time that every driver has reported."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        stale_after = round(self.parameters.stale_after * SECOND)
        body = load_body(self.parameters.model_file, self.parameters.joint_map)
        self._joints = JointCollector(self.parameters.joints or body.joints, stale_after)
        self._health = Health("joint_state_publisher: drivers", self.get_logger(), "reports")

    def on_joint_encoders(self, message: JointState) -> None:
        """Take what a driver measures."""
        stamp = messages.nanoseconds(message.header.stamp)
        values = [np.asarray(part) for part in (message.position, message.velocity, message.effort)]
        try:
            states = self._joints.take(stamp, message.name, *values)
        except ValueError as error:
            self._health.takes("reports", f"/joint_encoders: {error}")
            return
        if states is not None:
            self.publish_joint_states(messages.joint_states(states, self._joints.names))

    def on_diagnostics_timer(self) -> None:
        """Report what was refused, and which joints are silent."""
        stale = self._joints.stale
        problem = f"no driver reports {', '.join(stale)}" if stale else ""
        self.publish_diagnostics(self._health.report(self.get_clock().now().nanoseconds, problem))


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(JointStatePublisher, args, ParametersError)


if __name__ == "__main__":
    main()
