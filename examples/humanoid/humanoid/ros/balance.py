"""How the robot keeps its balance, as a message."""

from __future__ import annotations

from geometry_msgs.msg import Point, Point32, Polygon
from humanoid_interfaces.msg import BalanceState as BalanceStateMessage

from ..data import BalanceState
from . import messages


def balance_state(state: BalanceState) -> BalanceStateMessage:
    """For ~/balance of the whole-body controller."""
    capture, zmp = state.capture_point.tolist(), state.zero_moment_point.tolist()
    return BalanceStateMessage(
        header=messages.header(state.stamp, "odom"),
        centre_of_mass=messages.point(*state.centre_of_mass.tolist()),
        capture_point=Point(x=capture[0], y=capture[1]),
        zero_moment_point=Point(x=zmp[0], y=zmp[1]),
        support=Polygon(points=[Point32(x=x, y=y) for x, y in state.support.tolist()]),
    )
