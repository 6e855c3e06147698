"""Messages of never-compiled classes, filled with arrays, as subscribers with compiled classes receive them."""

import numpy as np
from common import never_compiled, rclpy, spin_until
from sensor_msgs.msg import Image, Imu, JointState
from test_msgs.msg import UnboundedSequences

rclpy.init()
node = rclpy.create_node("arrays")
frame = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
CASES = [
    (Image, {"data": frame}),
    (Image, {"data": frame[:, ::-1].astype(np.int64)}),
    (JointState, {"position": np.array([0.1, 0.2]), "name": np.array(["a", "b"])}),
    (Imu, {"orientation_covariance": np.diag([0.1, 0.2, 0.3])}),
    (UnboundedSequences, {"bool_values": np.array([True, False]), "byte_values": b"ab"}),
]
for compiled, values in CASES:
    ours = never_compiled(f"{compiled.__module__.split('.')[0]}/msg/{compiled.__name__}")
    received = []
    subscription = node.create_subscription(compiled, "arrays", received.append, 10)
    publisher = node.create_publisher(ours, "arrays", 10)
    spin_until(node, lambda end=publisher: end.get_subscription_count() == 1)
    publisher.publish(ours(**values))
    spin_until(node, lambda got=received: got)
    for field in values:
        print(compiled.__name__, field, np.array(getattr(received[0], field)).ravel().tolist())
    node.destroy_publisher(publisher)
    node.destroy_subscription(subscription)
node.destroy_node()
rclpy.shutdown()
