"""Actions about nodes."""

from launch_ros.actions._defaults import (
    PushRosNamespace,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetROSLogDir,
    SetUseSimTime,
)
from launch_ros.actions._lifecycle import LifecycleNode, LifecycleTransition
from launch_ros.actions._node import Node

PushROSNamespace = PushRosNamespace

__all__ = [
    "LifecycleNode",
    "LifecycleTransition",
    "Node",
    "PushROSNamespace",
    "PushRosNamespace",
    "SetParameter",
    "SetParametersFromFile",
    "SetROSLogDir",
    "SetRemap",
    "SetUseSimTime",
]
