"""Images through cv_bridge, and point clouds through tf2_sensor_msgs."""

import math
from array import array
from typing import Any

import numpy as np
import tf2_sensor_msgs
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import Image, PointCloud2, PointField
from sensor_msgs_py.point_cloud2 import create_cloud, read_points
from std_msgs.msg import Header
from tf2_ros import Buffer

bridge = CvBridge()
pixels = np.array([[[10, 20, 30], [255, 0, 0]], [[0, 255, 0], [0, 0, 255]]], np.uint8)
message = bridge.cv2_to_imgmsg(pixels, "bgr8", Header(frame_id="camera"))
print(
    message.encoding, message.height, message.width, message.step, message.header.frame_id, len(message.data)
)
assert np.array_equal(bridge.imgmsg_to_cv2(message), pixels)
assert np.array_equal(bridge.imgmsg_to_cv2(message, "rgb8"), pixels[:, :, ::-1])
print(bridge.imgmsg_to_cv2(message, "mono8").tolist())
print(bridge.imgmsg_to_cv2(message, "rgba8")[0].tolist())
print(bridge.imgmsg_to_cv2(message, "bgr16")[0].tolist(), bridge.imgmsg_to_cv2(message, "8UC3").shape)
depth = bridge.cv2_to_imgmsg(np.array([[0.5, 1.5]], np.float32))
print(
    depth.encoding,
    bridge.imgmsg_to_cv2(depth, "32FC1").tolist(),
    bridge.imgmsg_to_cv2(depth, "16UC1").tolist(),
)
padded = Image(
    height=2, width=1, encoding="mono16", step=4, is_bigendian=1, data=array("B", [1, 2, 0, 0, 3, 4, 0, 0])
)
print(bridge.imgmsg_to_cv2(padded).tolist(), bridge.imgmsg_to_cv2(padded, "mono8").tolist())
print(bridge.encoding_to_cvtype2("bgra8"), bridge.encoding_to_dtype_with_channels("bayer_rggb16"))


def refused(call: Any, *words: Any) -> None:
    try:
        call(*words)
    except (CvBridgeError, TypeError) as error:
        print(error)


refused(bridge.imgmsg_to_cv2, depth, "bgr8")
refused(bridge.imgmsg_to_cv2, message, "8UC1")
refused(bridge.imgmsg_to_cv2, message, "paper")
refused(bridge.cv2_to_imgmsg, pixels, "mono8")
refused(bridge.cv2_to_imgmsg, [1])
refused(bridge.cv2_to_imgmsg, np.zeros((1, 1), np.complex64))
refused(bridge.imgmsg_to_cv2, Image(height=2, width=2, encoding="mono8", step=2, data=array("B", [1])))

fields = [
    PointField(name=n, offset=4 * i, datatype=PointField.FLOAT32, count=1) for i, n in enumerate("xyzi")
]
cloud = create_cloud(Header(frame_id="a"), fields, [(1.0, 0.0, 0.0, 7.0), (0.0, 2.0, 0.0, 8.0)])
transform = TransformStamped(child_frame_id="a")
transform.header.frame_id = "b"
transform.transform.translation.z = 1.0
transform.transform.rotation.z, transform.transform.rotation.w = math.sin(math.pi / 4), math.cos(math.pi / 4)
buffer = Buffer()
buffer.set_transform_static(transform, "me")
moved = buffer.transform(cloud, "b")
assert isinstance(moved, PointCloud2)
print(moved.header.frame_id, [[round(float(v), 4) + 0.0 for v in p] for p in read_points(moved).tolist()])
print(tf2_sensor_msgs.transform_points([[1, 2, 3]], transform).round(4).tolist())
