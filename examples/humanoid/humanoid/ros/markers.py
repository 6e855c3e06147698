"""Obstacles as markers, and back, for whoever shows them."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ..robot.obstacles import Solid
from . import messages


def obstacle_markers(solids: Iterable[Solid], stamp: int) -> MarkerArray:
    """Obstacles where they are, after a marker that deletes all older ones."""
    markers = [Marker(header=messages.header(stamp, "odom"), action=Marker.DELETEALL)]
    for number, solid in enumerate(solids):
        red, green, blue = solid.colour
        markers.append(
            Marker(
                header=messages.header(stamp, "odom"),
                ns=solid.name,
                id=number,
                type=Marker.CUBE if solid.kind == "box" else Marker.CYLINDER,
                action=Marker.ADD,
                pose=Pose(
                    position=Point(x=solid.x, y=solid.y, z=solid.height / 2), orientation=Quaternion(w=1.0)
                ),
                scale=Vector3(x=solid.width, y=solid.width, z=solid.height),
                color=ColorRGBA(r=red, g=green, b=blue, a=1.0),
            )
        )
    return MarkerArray(markers=markers)


def read_obstacle_markers(message: MarkerArray) -> tuple[Solid, ...]:
    """The obstacles that markers show."""
    return tuple(
        Solid(
            marker.ns,
            "box" if marker.type == Marker.CUBE else "cylinder",
            (marker.color.r, marker.color.g, marker.color.b),
            marker.pose.position.x,
            marker.pose.position.y,
            marker.scale.x,
            marker.scale.z,
        )
        for marker in message.markers
        if marker.action == Marker.ADD
    )
