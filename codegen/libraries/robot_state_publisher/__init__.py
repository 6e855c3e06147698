"""Robots as their URDF describes them: programs that publish their frames and the states of their joints."""

from robot_state_publisher.urdf import Joint, Robot, UrdfError, read_urdf

__all__ = ["Joint", "Robot", "UrdfError", "read_urdf"]
