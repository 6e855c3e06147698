"""Prints messages as YAML and CSV, sets their fields, and finds interfaces."""

import json
from typing import Any

from geometry_msgs.msg import PoseStamped
from rosidl_runtime_py import (
    get_interfaces,
    get_message_interfaces,
    message_to_csv,
    message_to_ordereddict,
    message_to_yaml,
    set_message_fields,
)
from rosidl_runtime_py.utilities import (
    get_action,
    get_interface,
    get_message,
    get_namespaced_type,
    get_service,
)
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, Header, UInt8MultiArray

pose = PoseStamped()
setters = set_message_fields(
    pose,
    {"header": "auto", "pose": {"position": {"x": 1, "y": 2.5}, "orientation": {"w": 0.5}}},
    expand_header_auto=True,
)
for setter in setters:
    setter(pose.header.stamp.__class__(sec=3, nanosec=4))
print(message_to_yaml(pose), end="")
state = JointState(name=["a", "no: text", "ünder"], position=[0.0, 1.5, -2.0])
print(message_to_yaml(state, flow_style=True), end="")
print(message_to_csv(state, truncate_length=2))
print(message_to_yaml(state, truncate_length=2, no_str=True), end="")
print(message_to_csv(state, no_arr=True))
print(message_to_yaml(UInt8MultiArray(data=b"\x01\x02"), no_arr=True), end="")
print(json.dumps(message_to_ordereddict(Header(frame_id="map"), no_str=True)))
nested = Float64MultiArray()
set_message_fields(nested, {"layout": {"dim": [{"label": "x", "size": 2}]}, "data": [1, 2]})
print(message_to_csv(nested))


def refused(call: Any, *words: Any) -> None:
    try:
        call(*words)
    except (AttributeError, ImportError, LookupError, TypeError, ValueError) as error:
        print(type(error).__name__)


refused(set_message_fields, pose, {"nothing": 1})
refused(set_message_fields, pose, {"header": 5})
refused(set_message_fields, state, {"position": ["a"]})
refused(get_message, "std_msgs/String")
refused(get_message, "std_srvs/srv/Empty")
refused(get_message, "std_msgs/msg/Nothing")
refused(get_interface, "no_such_package/msg/Nothing")
refused(get_interfaces, ["no_such_package"])
print(get_message("std_msgs/msg/Header") is Header, get_service("std_srvs/srv/Empty").__name__)
print(get_action("test_msgs/action/Fibonacci").__name__, get_namespaced_type("a/msg/B").namespaced_name())
print(get_message_interfaces(["unique_identifier_msgs"]))
print(get_interfaces(["std_srvs"]), "std_msgs" in get_interfaces())
