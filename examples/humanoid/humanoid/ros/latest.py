"""The newest joint states, kept as they came."""

from __future__ import annotations

from rclpy.node import Node
from sensor_msgs.msg import JointState

from .. import data
from ..robot.body import OURS, Body
from . import messages


class LatestJoints:
    """The newest joint states, for a node that seldom needs them: a message is read when it is asked for."""

    def __init__(self, node: Node, body: Body = OURS) -> None:
        self._logger = node.get_logger()
        self._body = body
        self._unread: JointState | None = None
        self._read: data.JointStates | None = None

    def put(self, message: JointState) -> None:
        """Keep a message."""
        self._unread = message

    def get(self) -> data.JointStates | None:
        """The newest that could be read; None if there was none."""
        message, self._unread = self._unread, None
        if message is not None:
            try:
                self._read = messages.read_joint_states(message, self._body)
            except ValueError as error:
                self._logger.warning(f"/joint_states: {error}", throttle_duration_sec=1.0)
        return self._read
