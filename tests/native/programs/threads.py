"""Several threads publish on one publisher while others take from one subscription of the same topic."""

import sys
import threading
import time

from common import rclpy, spin_until
from humanoid_interfaces.msg import FootstepPlan
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import QoSProfile

SECONDS = 3.0

rclpy.init()
sys.setswitchinterval(1e-5)
node = rclpy.create_node("threads")
taken = []
subscription = node.create_subscription(
    FootstepPlan, "plan", taken.append, QoSProfile(depth=200), callback_group=ReentrantCallbackGroup()
)
publisher = node.create_publisher(FootstepPlan, "plan", QoSProfile(depth=200))
spin_until(node, publisher.get_subscription_count)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
end = time.monotonic() + SECONDS
published = [0, 0, 0]
errors: list[str] = []


def publish(number: int) -> None:
    while time.monotonic() < end:
        publisher.publish(FootstepPlan(plan_id=number))
        published[number] += 1


def take() -> None:
    while time.monotonic() < end:
        try:
            executor.spin_once(timeout_sec=0.01)
        except Exception as error:
            errors.append(repr(error))


workers = [threading.Thread(target=publish, args=(n,), daemon=True) for n in range(3)]
workers.append(threading.Thread(target=take, daemon=True))
for worker in workers:
    worker.start()
for worker in workers:
    worker.join(SECONDS + 20)
print("stuck", [worker.is_alive() for worker in workers].count(True))
print("published", all(published), "taken", bool(taken), "errors", errors[:1])
executor.shutdown()
node.destroy_node()
rclpy.shutdown()
