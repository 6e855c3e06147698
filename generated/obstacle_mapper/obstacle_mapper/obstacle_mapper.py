"""The node obstacle_mapper: keeps a map of the floor from the images of the head camera."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import TransformStamped
from humanoid.data import SECOND
from humanoid.robot.external import load_model
from humanoid.ros import messages
from humanoid.ros.grids import occupancy_grid
from humanoid.ros.images import read_image, read_lens
from humanoid.ros.recent import History
from humanoid.ros.running import run
from humanoid.sensing.camera import Lens
from humanoid.sensing.floor_view import Viewpoints
from humanoid.sensing.mapping import FloorMap
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import CameraInfo, Image, JointState
from tf2_msgs.msg import TFMessage

from obstacle_mapper._obstacle_mapper_base import ObstacleMapperBase
from obstacle_mapper._obstacle_mapper_parameters import ParametersError

_KEPT = 256  # joints and poses: those of a second, by which an image may come late
_APART = 50_000_000  # ns that image, joints and pose may be apart: the robot moves by centimetres meanwhile


class ObstacleMapper(ObstacleMapperBase):
    """Adds every image to the map, with the joints and the pose of its moment."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        values = self.parameters
        model = load_model(values.model_file, values.joint_map)
        self._body = model.body
        self._viewpoints = Viewpoints(model)
        self._map = FloorMap(values.half_size, values.resolution)
        self._newest = -1  # stamp of the newest image in it
        self._lens: Lens | None = None
        self._joints = History[JointState](_KEPT)
        self._bases = History[TransformStamped](_KEPT)  # from odom to base_link
        self._published: OccupancyGrid | None = None

    def on_head_camera_camera_info(self, message: CameraInfo) -> None:
        """Take the calibration."""
        self._lens = read_lens(message)

    def on_joint_states(self, message: JointState) -> None:
        """Keep the joints."""
        self._joints.put(messages.nanoseconds(message.header.stamp), message)

    def on_tf(self, message: TFMessage) -> None:
        """Keep the pose of base_link."""
        for transform in message.transforms:
            if transform.child_frame_id == "base_link" and transform.header.frame_id == "odom":
                self._bases.put(messages.nanoseconds(transform.header.stamp), transform)

    def on_head_camera_image_raw(self, message: Image) -> None:
        """Add what the image shows, and publish the map if that changes it."""
        if self._lens is None or not (self._joints and self._bases):
            return
        stamp = messages.nanoseconds(message.header.stamp)
        try:
            self._look(stamp, message, self._lens)
        except ValueError as error:
            self.get_logger().warning(f"not mapped: {error}", throttle_duration_sec=5.0)
            return
        grid = occupancy_grid(self._map.grid, stamp)
        if self._published is None or grid.data != self._published.data:
            self._published = grid
            self.publish_map(grid)

    def _look(self, stamp: int, message: Image, lens: Lens) -> None:
        """Add an image to the map. Raises ValueError if that is not possible."""
        joints, base = self._joints.nearest(stamp, _APART), self._bases.nearest(stamp, _APART)
        if joints is None or base is None:
            raise ValueError(f"there are no joints, or no pose, within {_APART / SECOND:g} s of the image")
        if stamp < self._newest:  # time starts again, and perhaps among other obstacles
            self._map = FloorMap(self.parameters.half_size, self.parameters.resolution)
        self._newest = stamp
        picture = read_image(message)
        angles = messages.read_joint_states(joints, self._body).position
        if picture.shape[:2] != (lens.height, lens.width):
            raise ValueError("an image of another size than its calibration")
        place = messages.numbers(base.transform.translation)
        viewpoint = self._viewpoints.of(place, messages.numbers(base.transform.rotation), angles)
        memory = round(self.parameters.memory * SECOND)
        self._map.see(stamp, picture, lens, viewpoint, self.parameters.range, memory)


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(ObstacleMapper, args, ParametersError)


if __name__ == "__main__":
    main()
