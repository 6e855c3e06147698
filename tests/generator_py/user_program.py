"""A user's program for type checkers: they must report exactly the lines that end in `# wrong`."""

from __future__ import annotations

import copy
from array import array
from typing import Any, assert_type

import numpy
from class_msgs.action import Walk
from class_msgs.msg import Defaults, Status, Words
from class_msgs.srv import Plan
from geometry_msgs.msg import Point, Pose, PoseStamped, Transform, TransformStamped, Twist
from ifgen_runtime.numpy import (
    as_array,
    from_grid_array,
    from_image_array,
    from_point_array,
    from_ranges,
    from_transform_matrix,
    grid_array,
    image_array,
    point_array,
    scan_points,
    transform_matrix,
)
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from sensor_msgs.msg import Image, LaserScan, PointCloud2
from std_msgs.msg import Header

defaults = Defaults(x=1.0, names=["a"], gains=[0.5], mask=[1, 2, 3], corners=[Point(x=1.0), Point()])
assert_type(defaults.x, float)
assert_type(defaults.name, str)
assert_type(defaults.names, list[str])
assert_type(defaults.gains, array[float])
assert_type(defaults.mask, NDArray[numpy.uint8])
assert_type(defaults.corners[0].y, float)
assert_type(defaults.stamp.sec, int)
assert_type(Defaults.NAMES__DEFAULT, list[str])
assert_type(copy.deepcopy(defaults), Defaults)
defaults.x = 2
defaults.gains = (0.1 * index for index in range(3))
defaults.gains = numpy.zeros(3)
defaults.mask = numpy.zeros(3)
defaults.mask = [1, 2, 3]
defaults.mask[0] = 4
defaults.names.append("b")

speeds: list[int] = [Status.STATUS_RUNNING, Status.StatusEnum.RUNNING]
status = Status(status=Status.StatusEnum.RUNNING, modes=[1, 2])
assert_type(status.status, int)
assert_type(Status.get_fields_and_field_types(), dict[str, str])
words = Words(from_=1, class_="c", lambda_=[1.0])

image = from_image_array(Image, numpy.zeros((2, 3), numpy.uint8), "mono8", header=Header())
assert_type(image, Image)
assert_type(image_array(image), NDArray[Any])
assert_type(as_array(image.data), NDArray[numpy.integer[Any]])
assert_type(as_array(LaserScan().ranges), NDArray[numpy.floating[Any]])
assert_type(as_array(defaults.mask), NDArray[numpy.uint8])
assert_type(from_point_array(PointCloud2, numpy.zeros((2, 3))), PointCloud2)
assert_type(point_array(PointCloud2()), NDArray[numpy.void])
assert_type(from_ranges(LaserScan, [1.0], angles=(0, 1), limits=(0, 1)), LaserScan)
assert_type(scan_points(LaserScan()), NDArray[numpy.float64])
assert_type(from_grid_array(OccupancyGrid, numpy.zeros((2, 3), int), resolution=0.1), OccupancyGrid)
assert_type(grid_array(OccupancyGrid()), NDArray[numpy.int8])
assert_type(from_transform_matrix(Pose, numpy.identity(4)), Pose)
matrices = [transform_matrix(m) for m in (Pose(), PoseStamped(), Transform(), TransformStamped())]
assert_type(matrices, list[NDArray[numpy.float64]])


def plan(request: Plan.Request, response: Plan.Response) -> Plan.Response:
    response.ok = request.speed > 0
    return response


assert_type(plan(Plan.Request(speed=1), Plan.Response()).ok, bool)
goal = Walk.Impl.SendGoalService.Request(goal=Walk.Goal(distance=1.0))
assert_type(goal.goal.distance, float)
feedback: Walk.Feedback = Walk.Impl.FeedbackMessage(feedback=Walk.Feedback(left=0.5)).feedback

Defaults(y=1.0)  # wrong
Defaults(1.0)  # wrong
Defaults(x="one")  # wrong
Defaults(corners=[Status()])  # wrong
Plan.Request(ok=True)  # wrong
Status.STATUS_RUNNING = 3  # wrong
defaults.name = 3  # wrong
defaults.gains = 3  # wrong
defaults.nam = "x"  # wrong
print(Status.STATUS_WALKING)  # wrong
print(Status.StatusEnum.WALKING)  # wrong
plan(Plan.Response(), Plan.Response())  # wrong
image_array(PointCloud2())  # wrong
from_image_array(LaserScan, numpy.zeros((2, 3)), "mono8")  # wrong
transform_matrix(Twist())  # wrong
as_array([True])  # wrong
