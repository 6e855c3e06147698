"""A snapshot of a small robot."""

from __future__ import annotations

from ifgen_tools.top.snapshot import ExecutorRow, NodeRow, ServiceRow, Snapshot, SubscriptionRow, TopicRow

ROBOT = Snapshot(
    at=0.0,
    transport="local",
    nodes=(
        NodeRow("/camera", "robot 41", 2, 0, 7, 0, 0.031),
        NodeRow("/arm/controller", "robot 41", 1, 2, 8, 0, 0.953),
        NodeRow("/elsewhere", None, 1, 0, 0, 1, None),
    ),
    topics=(
        TopicRow("/camera/image_raw", ("sensor_msgs/msg/Image",), ("/camera",), (), 29.97, 27.6e6),
        TopicRow(
            "/arm/very_long_name_of_a_topic/joint_states",
            ("sensor_msgs/msg/JointState",),
            ("/camera", "/elsewhere"),
            ("/arm/controller",),
            1000.0,
            None,
            missed=12,
            fill=1.0,
        ),
        TopicRow("/quiet", ("std_msgs/msg/String",), (), ("/arm/controller",), 0.0, 0.0, missed=0, fill=0.1),
    ),
    subscriptions=(
        SubscriptionRow("/arm/very_long_name_of_a_topic/joint_states", "/arm/controller", 10, 10, 2, 10),
        SubscriptionRow("/quiet", "/arm/controller", 1, 0, 0, 0),
    ),
    executors=(
        ExecutorRow(
            "robot 41",
            "SingleThreadedExecutor",
            ("/arm/controller",),
            1,
            0.953,
            1012.0,
            0.0213,
            "timer Arm.step of /arm/controller",
        ),
    ),
    services=(ServiceRow("/arm/reset", ("std_srvs/srv/Trigger",), ("/arm/controller",), ("/elsewhere",)),),
    silent=("/elsewhere",),
)
