"""A node that imports what comes beside rclpy."""

from __future__ import annotations

import message_filters
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
from message_filters import Cache, Subscriber
from message_filters.delta_filter import PathDeltaFilter
from message_filters.input_aligner import InputAligner
from rclpy.duration import Duration
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header


class Fusion(Node):
    def __init__(self) -> None:
        super().__init__("fusion")
        self.images = Subscriber(
            self, Image, "image", qos_profile=10, callback_group=self.default_callback_group
        )
        self.infos = Cache(Subscriber(self, CameraInfo, "camera_info"), cache_size=3, allow_headerless=True)
        self.sync = message_filters.ApproximateTimeSynchronizer([self.images, self.infos], 10, slop=0.1)
        self.sync.registerCallback(self.fuse, "an argument")
        self.changes = PathDeltaFilter(["height", "width"], self.images)
        self.aligner = InputAligner(Duration(seconds=1), [self.images, self.infos])
        self.get_logger().set_level(LoggingSeverity.DEBUG)

    def fuse(self, image: Image, info: CameraInfo, argument: str) -> None:
        cloud: PointCloud2 = point_cloud2.create_cloud_xyz32(Header(), [(0.1, 0.2, 0.3)])
        points = point_cloud2.read_points(cloud, field_names=("x", "y"), skip_nans=True)
        self.get_logger().info(f"{points['x'].mean()} {self.aligner.getQueueStatus(0).active} {argument}")
        try:
            share: str = get_package_share_directory("fusion")
        except PackageNotFoundError:
            share = self.images.getTopic()
        self.get_logger().info(share)
        self.infos.getInterval(0.1, 0.2)  # refused: arg-type, reportArgumentType
        Subscriber(self, Image, 3)  # refused: arg-type, reportArgumentType
        point_cloud2.read_points(image)  # refused: arg-type, reportArgumentType
        get_package_share_directory()  # refused: call-arg, reportCallIssue
        _ = info
