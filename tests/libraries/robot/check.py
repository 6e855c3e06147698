"""Prints the frames of the robot and of the camera, and where a finger is in the map."""

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from tf2_ros import Buffer, TransformListener

rclpy.init()
node = rclpy.create_node("check")
executor = SingleThreadedExecutor()
executor.add_node(node)
buffer = Buffer()
listener = TransformListener(buffer, node)
latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # /tf_static has two publishers
descriptions: list[str] = []
topics: dict[str, str] = {}


def note(topic: str, message: TFMessage) -> None:
    for each in message.transforms:
        topics[each.child_frame_id] = topic


node.create_subscription(
    String, "robot_description", lambda message: descriptions.append(message.data), latched
)
node.create_subscription(TFMessage, "/tf", lambda message: note("/tf", message), 10)
node.create_subscription(TFMessage, "/tf_static", lambda message: note("/tf_static", message), latched)
end = node.get_clock().now() + Duration(seconds=40)
while len(topics) < 6 or not descriptions or not buffer.can_transform("map", "other_finger", Time()):
    executor.spin_once(timeout_sec=0.1)
    assert node.get_clock().now() < end, (topics, descriptions)
for child, topic in sorted(topics.items()):
    print(child, topic, flush=True)
found = buffer.lookup_transform("map", "other_finger", Time()).transform
at, turned = found.translation, found.rotation
print(*(f"{value:.4f}" for value in (at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w)), flush=True)
print(descriptions[0].split()[1], flush=True)
