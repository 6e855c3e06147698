"""The names and parameters of upstream's public API, as of Jazzy 0.36.20."""

from __future__ import annotations

import inspect
from importlib import import_module
from typing import Any

import pytest
import tf2_geometry_msgs
import tf2_py
import tf2_ros

ENDS = "target_frame source_frame time"
FULL = "target_frame target_time source_frame source_time fixed_frame"
PARAMETERS = {
    "tf2_py.BufferCore": {
        "__init__": "cache_time",
        "set_transform": "transform authority",
        "set_transform_static": "transform authority",
        "can_transform_core": ENDS,
        "can_transform_full_core": FULL,
        "lookup_transform_core": ENDS,
        "lookup_transform_full_core": FULL,
        "get_latest_common_time": "target_frame source_frame",
        "lookupVelocityCore": "tracking_frame observation_frame time averaging_interval",
        "lookupVelocityFullCore": "tracking_frame observation_frame reference_frame reference_point "
        "reference_point_frame time averaging_interval",
        "clear": "",
        "all_frames_as_yaml": "",
        "all_frames_as_string": "",
        "_allFramesAsDot": "time",
        "_chain": FULL,
        "_frameExists": "frame_id",
        "_getFrameStrings": "",
    },
    "tf2_ros.buffer.Buffer": {
        "__init__": "cache_time node",
        "set_transform": "transform authority",
        "set_transform_static": "transform authority",
        "lookup_transform": f"{ENDS} timeout",
        "lookup_transform_async": ENDS,
        "lookup_transform_full": f"{FULL} timeout",
        "lookup_transform_full_async": FULL,
        "can_transform": f"{ENDS} timeout return_debug_tuple",
        "can_transform_full": f"{FULL} timeout return_debug_tuple",
        "wait_for_transform_async": ENDS,
        "wait_for_transform_full_async": FULL,
        "time_jump_callback": "time_jump",
        "transform": "object_stamped target_frame timeout new_type",
        "transform_full": "object_stamped target_frame target_time fixed_frame timeout new_type",
    },
    "tf2_ros.buffer_client.BufferClient": {
        "__init__": "node ns check_frequency timeout_padding",
        "lookup_transform": f"{ENDS} timeout",
        "lookup_transform_full": f"{FULL} timeout",
        "can_transform": f"{ENDS} timeout",
        "can_transform_full": f"{FULL} timeout",
    },
    "tf2_ros.buffer_interface.TransformRegistration": {"print_me": "", "add": "key callback", "get": "key"},
    "tf2_ros.buffer_interface.ConvertRegistration": {
        "add_from_msg": "key callback",
        "add_to_msg": "key callback",
        "add_convert": "key callback",
        "get_from_msg": "key",
        "get_to_msg": "key",
        "get_convert": "key",
    },
    "tf2_ros.buffer_interface.TypeException": {"__init__": "errstr"},
    "tf2_ros.transform_broadcaster.TransformBroadcaster": {
        "__init__": "node qos",
        "sendTransform": "transform",
    },
    "tf2_ros.static_transform_broadcaster.StaticTransformBroadcaster": {
        "__init__": "node qos",
        "sendTransform": "transform",
    },
    "tf2_ros.transform_listener.TransformListener": {
        "__init__": "buffer node spin_thread qos static_qos tf_topic tf_static_topic static_only",
        "unregister": "",
        "callback": "data",
        "static_callback": "data",
    },
}
FUNCTIONS = {
    "tf2_ros.buffer_interface.Stamped": "obj stamp frame_id",
    "tf2_ros.buffer_interface.convert": "a b_type",
    "tf2_geometry_msgs.to_msg_msg": "msg",
    "tf2_geometry_msgs.from_msg_msg": "msg",
    "tf2_geometry_msgs.transform_covariance": "cov_in transform",
    "tf2_geometry_msgs.do_transform_point": "point transform",
    "tf2_geometry_msgs.do_transform_vector3": "vector3 transform",
    "tf2_geometry_msgs.do_transform_pose": "pose transform",
    "tf2_geometry_msgs.do_transform_pose_stamped": "pose transform",
    "tf2_geometry_msgs.do_transform_pose_with_covariance_stamped": "pose transform",
    "tf2_geometry_msgs.do_transform_polygon_stamped": "polygon transform",
}


def parameters(function: Any) -> str:
    return " ".join(name for name in inspect.signature(function).parameters if name != "self")


def named(path: str) -> Any:
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


@pytest.mark.parametrize("path", PARAMETERS)
def test_methods(path: str) -> None:
    cls = named(path)
    assert {name: parameters(getattr(cls, name)) for name in PARAMETERS[path]} == PARAMETERS[path]


def test_functions() -> None:
    assert {path: parameters(named(path)) for path in FUNCTIONS} == FUNCTIONS
    public = {name for name in vars(tf2_geometry_msgs) if inspect.isfunction(vars(tf2_geometry_msgs)[name])}
    assert public == {path.rpartition(".")[2] for path in FUNCTIONS if path.startswith("tf2_geometry_msgs")}


def test_what_upstreams_packages_export() -> None:
    for name in ("Connectivity", "Extrapolation", "InvalidArgument", "Lookup", "Timeout"):
        exception = getattr(tf2_ros, f"{name}Exception")
        assert exception is getattr(tf2_py, f"{name}Exception")
        assert issubclass(exception, tf2_py.TransformException)
    for path in [*PARAMETERS, *FUNCTIONS]:
        if path.startswith("tf2_ros"):
            assert getattr(tf2_ros, path.rpartition(".")[2]) is named(path)
    # Messages and classes of rclpy that programs take from here.
    for name in ("TransformStamped", "PoseStamped", "PointStamped", "TFMessage", "Duration", "Time", "Node"):
        assert inspect.isclass(getattr(tf2_ros, name))
    for name in ("TransformStamped", "PoseStamped", "PointStamped", "Pose", "Point"):
        assert inspect.isclass(getattr(tf2_geometry_msgs, name))
    assert tf2_ros.transform_listener.DEFAULT_TF_TOPIC == "/tf"
    assert tf2_ros.transform_listener.DEFAULT_STATIC_TF_TOPIC == "/tf_static"


def test_keywords_of_what_is_stored() -> None:
    buffer = tf2_ros.Buffer()
    message = tf2_ros.TransformStamped(child_frame_id="base")
    message.header.frame_id = "map"
    buffer.set_transform(transform=message, authority="test")
    buffer.set_transform_static(transform=message, authority="test")
    assert buffer._frameExists("map")
