"""Look at received pixels without a copy, on either transport: `exchange_views.py TRANSPORT`."""

import sys

import ifgen

ifgen.activate(sys.argv[1])

import numpy as np  # noqa: E402  # the path comes first
import rclpy  # noqa: E402
from ifgen_runtime import deserialize, to_dict  # noqa: E402
from ifgen_runtime.numpy import from_image_array, image_array  # noqa: E402
from sensor_msgs.msg import Image  # noqa: E402

received = []


def on_image(data: bytes) -> None:
    """Keep the image."""
    received.append(deserialize(data, Image, views=True))


rclpy.init()
node = rclpy.create_node("exchange")
node.create_subscription(Image, "in", on_image, 10, raw=True)
publisher = node.create_publisher(Image, "in", 10)
sent = from_image_array(Image, np.arange(24, dtype=np.uint8).reshape(2, 4, 3), "rgb8")


def exchange(message: Image) -> Image:
    """The message as it arrives."""
    publisher.publish(message)
    for _ in range(500):
        if not received:
            rclpy.spin_once(node, timeout_sec=0.02)
    return received.pop()


for _ in range(500):
    if not publisher.get_subscription_count():
        rclpy.spin_once(node, timeout_sec=0.02)
image = exchange(sent)
print(
    type(image.data).__name__,
    image.data.flags.writeable,
    to_dict(image) == to_dict(sent),
    image_array(image)[1, 3].tolist(),
)
image.data[0] = 99
print(exchange(image).data[:3].tolist())  # a message with views is published like any other
if sys.argv[1] == "rclpy":
    try:
        node.create_subscription(Image, "in", on_image, 10, views=True)
    except TypeError as error:
        print("rclpy:", error)
node.destroy_node()
rclpy.shutdown()
