"""Actions about nodes."""

from launch_ros.actions._defaults import (
    PushRosNamespace,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetROSLogDir,
    SetUseSimTime,
)
from launch_ros.actions.composable_node_container import ComposableNodeContainer, LoadComposableNodes
from launch_ros.actions.lifecycle_node import LifecycleNode, LifecycleTransition
from launch_ros.actions.node import Node
from launch_ros.actions.ros_timer import RosTimer
from launch_ros.actions.ros_timer import RosTimer as ROSTimer

PushROSNamespace = PushRosNamespace

__all__ = [
    "ComposableNodeContainer",
    "LifecycleNode",
    "LifecycleTransition",
    "LoadComposableNodes",
    "Node",
    "PushROSNamespace",
    "PushRosNamespace",
    "ROSTimer",
    "RosTimer",
    "SetParameter",
    "SetParametersFromFile",
    "SetROSLogDir",
    "SetRemap",
    "SetUseSimTime",
]
