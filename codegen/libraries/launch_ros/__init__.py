"""Launch descriptions of ROS nodes.

The part of launch_ros of ROS 2 Jazzy that `ifgen launch` runs, under upstream's names.
"""

from launch_ros import actions as actions
from launch_ros import descriptions as descriptions
from launch_ros import event_handlers as event_handlers
from launch_ros import events as events
from launch_ros import parameter_descriptions as parameter_descriptions
from launch_ros import substitutions as substitutions

__all__ = [
    "actions",
    "descriptions",
    "event_handlers",
    "events",
    "parameter_descriptions",
    "substitutions",
]
