"""Tests of what the node obstacle_mapper does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from geometry_msgs.msg import TransformStamped
from humanoid.data import SECOND
from humanoid.robot.table import JOINT_NAMES
from humanoid.ros import messages
from humanoid.ros.grids import read_occupancy_grid
from humanoid.ros.images import camera_info, image
from humanoid.sensing.camera import lens_of
from nav_msgs.msg import OccupancyGrid
from obstacle_mapper._obstacle_mapper_base import (
    HEAD_CAMERA_CAMERA_INFO_SUBSCRIPTION_QOS,
    HEAD_CAMERA_IMAGE_RAW_SUBSCRIPTION_QOS,
    JOINT_STATES_SUBSCRIPTION_QOS,
    MAP_PUBLISHER_QOS,
    TF_SUBSCRIPTION_QOS,
)
from obstacle_mapper.obstacle_mapper import ObstacleMapper
from sensor_msgs.msg import CameraInfo, Image, JointState
from tf2_msgs.msg import TFMessage

LENS = lens_of(160, 120, 60.0)
STAMP = 2_000_000_000


class World:
    """Whoever sends the mapper what it needs, and listens to its map."""

    def __init__(self, ros: Any) -> None:
        self.maps: list[OccupancyGrid] = []
        create = ros.peer.create_publisher
        self._images = create(Image, "/head_camera/image_raw", HEAD_CAMERA_IMAGE_RAW_SUBSCRIPTION_QOS)
        self._infos = create(CameraInfo, "/head_camera/camera_info", HEAD_CAMERA_CAMERA_INFO_SUBSCRIPTION_QOS)
        self._joints = create(JointState, "/joint_states", JOINT_STATES_SUBSCRIPTION_QOS)
        self._poses = create(TFMessage, "/tf", TF_SUBSCRIPTION_QOS)
        ros.peer.create_subscription(OccupancyGrid, "/map", self.maps.append, MAP_PUBLISHER_QOS)

    def tell(self, stamp: int = STAMP, x: float = 0.0) -> None:
        """Calibration, joints (the head looks ahead) and the pose of the pelvis, 0.8 m above the floor."""
        zeros = array("d", [0.0] * len(JOINT_NAMES))
        pose = TransformStamped(header=messages.header(stamp, "odom"), child_frame_id="base_link")
        pose.transform.translation.x, pose.transform.translation.z = x, 0.8
        pose.transform.rotation.w = 1.0
        self._infos.publish(camera_info(messages.header(stamp, "camera"), LENS))
        self._poses.publish(TFMessage(transforms=[pose]))
        self._joints.publish(
            JointState(
                header=messages.header(stamp, ""),
                name=list(JOINT_NAMES),
                position=zeros,
                velocity=zeros,
                effort=zeros,
            )
        )

    def show(self, stamp: int = STAMP, left: int = 70) -> None:
        """A grey floor, and something red that stands on it, 20 columns wide."""
        picture = np.full((120, 160, 3), 90, dtype=np.uint8)
        picture[70:110, left : left + 20] = (200, 30, 30)
        self._images.publish(image(messages.header(stamp, "camera"), picture))


def test_what_is_red_is_mapped_where_its_lower_edge_is(ros: Any) -> None:
    node = ros.start(ObstacleMapper)
    world = World(ros)
    ready = lambda: node._lens and node._joints and node._bases  # noqa: E731  # a name for two tests
    ros.deliver(world.tell, ready, "calibration, joints and pose")
    ros.deliver(world.show, lambda: world.maps, "message on /map")
    grid = read_occupancy_grid(world.maps[-1])
    occupied = grid.occupied()
    # The camera is 1.38 m above the pelvis' floor; 50 pixels below the horizon are 25.7 degrees.
    nearest = float(np.min(np.hypot(occupied[:, 0], occupied[:, 1])))
    assert nearest == pytest.approx(1.38 / (50 / LENS.focal), abs=0.25)
    assert np.abs(occupied[:, 1]).max() < 0.4
    count = len(world.maps)
    world.show()
    assert not ros.spins_until(lambda: len(world.maps) > count + 1, 0.2)  # nothing new, or once more


def test_time_that_starts_again_begins_with_an_empty_map(ros: Any) -> None:
    node = ros.start(ObstacleMapper)
    world = World(ros)
    maps: list[np.ndarray] = []
    for stamp, left in ((STAMP, 20), (STAMP // 2, 120)):
        count = len(world.maps)
        ros.deliver(
            lambda stamp=stamp: world.tell(stamp),
            lambda stamp=stamp: node._bases.nearest(stamp, 0) and node._joints.nearest(stamp, 0),
            "pose",
        )
        ros.deliver(
            lambda stamp=stamp, left=left: world.show(stamp, left),
            lambda count=count: len(world.maps) > count,
            "message on /map",
        )
        maps.append(read_occupancy_grid(world.maps[-1]).occupied())
    assert maps[0][:, 1].min() > 0.2  # to the left only
    assert maps[1][:, 1].max() < -0.2  # to the right only


def test_an_image_without_a_pose_of_its_time_is_not_mapped(ros: Any) -> None:
    node = ros.start(ObstacleMapper)
    world = World(ros)
    ready = lambda: node._lens and node._joints and node._bases  # noqa: E731  # a name for two tests
    ros.deliver(lambda: world.tell(STAMP // 2), ready, "calibration, joints and pose")
    world.show()
    assert not ros.spins_until(lambda: world.maps, 0.3)


def test_an_image_that_comes_late_is_mapped_from_where_it_was_taken(ros: Any) -> None:
    node = ros.start(ObstacleMapper)
    world = World(ros)
    for stamp, place in ((STAMP, 0.0), (STAMP + SECOND // 2, 1.0)):
        ros.deliver(
            lambda stamp=stamp, place=place: world.tell(stamp, place),
            lambda stamp=stamp: node._bases.nearest(stamp, 0) and node._joints.nearest(stamp, 0),
            "joints and pose",
        )
    ros.deliver(world.show, lambda: world.maps, "message on /map")
    occupied = read_occupancy_grid(world.maps[-1]).occupied()
    assert occupied[:, 0].min() == pytest.approx(1.38 / (50 / LENS.focal), abs=0.25)
