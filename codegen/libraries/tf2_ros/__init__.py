"""tf2 for nodes: a buffer of transforms that listens to `/tf`, and what sends them there.

The names, signatures and texts are those of ROS 2 Jazzy's `tf2_ros_py`. `BufferServer`, which upstream has in
C++ only, is here as well. All of it stands on rclpy's public API.
"""

# Upstream's modules export what they import. Programs take messages and rclpy's classes from here, too.
from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
)
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from rclpy.time import Time
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from tf2_msgs.action import LookupTransform
from tf2_msgs.msg import TFMessage
from tf2_msgs.srv import FrameGraph
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from tf2_ros.buffer import Buffer
from tf2_ros.buffer_client import BufferClient
from tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from tf2_ros.buffer_server import BufferServer
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.static_transform_listener import StaticTransformListener
from tf2_ros.transform_broadcaster import TransformBroadcaster
from tf2_ros.transform_listener import TransformListener

__all__ = [
    "Buffer",
    "BufferClient",
    "BufferCore",
    "BufferInterface",
    "BufferServer",
    "ConnectivityException",
    "ConvertRegistration",
    "DurabilityPolicy",
    "Duration",
    "ExtrapolationException",
    "FrameGraph",
    "Header",
    "HistoryPolicy",
    "InvalidArgumentException",
    "LookupException",
    "LookupTransform",
    "Node",
    "NotImplementedException",
    "PointCloud2",
    "PointStamped",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "QoSProfile",
    "Stamped",
    "StaticTransformBroadcaster",
    "StaticTransformListener",
    "TFMessage",
    "Time",
    "TimeoutException",
    "TransformBroadcaster",
    "TransformException",
    "TransformListener",
    "TransformRegistration",
    "TransformStamped",
    "TypeException",
    "Vector3Stamped",
    "convert",
]
