"""Compiled and never-compiled classes of one type in one context, each publishing to both."""

from common import never_compiled, rclpy, spin_until
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String

rclpy.init()
node = rclpy.create_node("interop")

CASES = [
    (String, {"data": "through"}),
    (Int32, {"data": 7}),  # a plain type, for which middlewares have short cuts
    (JointState, {"name": ["knee", "hip"], "position": [0.25, 1.0]}),
]
for compiled, values in CASES:
    ours = never_compiled(f"{compiled.__module__.split('.')[0]}/msg/{compiled.__name__}")
    assert type(ours).__bases__ != type(compiled).__bases__
    for order in ((ours, compiled), (compiled, ours)):
        topic = f"{compiled.__name__}_{order[0] is ours}"
        publishers = [node.create_publisher(cls, topic, 10) for cls in order]
        received = {cls: [] for cls in order}
        for cls in order:
            node.create_subscription(cls, topic, received[cls].append, 10)
        spin_until(node, lambda ends=publishers: all(end.get_subscription_count() == 2 for end in ends))
        for publisher, cls in zip(publishers, order, strict=True):
            publisher.publish(cls(**values))
        spin_until(node, lambda got=received: all(len(messages) == 2 for messages in got.values()))
        for cls in (compiled, ours):
            print(topic, cls is ours, [message == cls(**values) for message in received[cls]])
node.destroy_node()
rclpy.shutdown()
