"""Publish what numpy made, and print what arrives: `exchange.py TRANSPORT`."""

import sys

import ifgen

ifgen.activate(sys.argv[1])

import numpy as np  # noqa: E402  # the path comes first
import rclpy  # noqa: E402
from geometry_msgs.msg import TransformStamped  # noqa: E402
from ifgen_runtime import serialize  # noqa: E402
from ifgen_runtime.numpy import (  # noqa: E402
    from_grid_array,
    from_image_array,
    from_point_array,
    from_ranges,
    from_transform_matrix,
    grid_array,
    image_array,
    scan_points,
    transform_matrix,
    xyz_array,
)
from nav_msgs.msg import OccupancyGrid  # noqa: E402
from sensor_msgs.msg import Image, LaserScan, PointCloud2  # noqa: E402

pixels = np.arange(24, dtype=np.uint16).reshape(2, 4, 3)[:, ::-1]
coordinates = np.arange(6, dtype=np.float32).reshape(2, 3) / 10
cells = np.array([[0, 100, -1]], np.int8)
turn = np.array([[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1.0]])
CASES = [
    (from_image_array(Image, pixels, "bgr16"), image_array, pixels),
    (from_point_array(PointCloud2, coordinates), xyz_array, coordinates),
    (from_grid_array(OccupancyGrid, cells, resolution=0.05), grid_array, cells),
    (
        from_ranges(LaserScan, [0.1, 2.5], angles=(0, 0), limits=(0.1, 9)),
        scan_points,
        np.float32([[0.1, 0], [2.5, 0]]),
    ),
    (from_transform_matrix(TransformStamped, turn), transform_matrix, turn),
]

rclpy.init()
node = rclpy.create_node("exchange")
for message, view_of, expected in CASES:
    received = []
    name = type(message).__name__
    node.create_subscription(type(message), name, received.append, 10)
    publisher = node.create_publisher(type(message), name, 10)
    for _ in range(500):
        if not publisher.get_subscription_count():
            rclpy.spin_once(node, timeout_sec=0.02)
    publisher.publish(message)
    for _ in range(500):
        if not received:
            rclpy.spin_once(node, timeout_sec=0.02)
    array = view_of(received[0])
    array[0, 0] = array[0, 0]  # what is received can be written
    print(name, serialize(received[0]) == serialize(message), bool(np.allclose(array, expected, atol=1e-7)))
print("ours" if hasattr(Image, "__type_hash__") else "compiled")
node.destroy_node()
rclpy.shutdown()
