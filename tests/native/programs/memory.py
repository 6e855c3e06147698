"""100,000 messages through one topic, then 1,000 entities made and destroyed: memory stays where it is."""

from common import rclpy, resident_kib, spin_until
from humanoid_interfaces.msg import FootstepPlan
from humanoid_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node("memory")
subscription = node.create_subscription(FootstepPlan, "plan", lambda message: None, 10)
publisher = node.create_publisher(FootstepPlan, "plan", 10)
spin_until(node, publisher.get_subscription_count)


def exchange(count: int) -> int:
    taken = 0
    for _ in range(count):
        publisher.publish(FootstepPlan())
        with subscription.handle:
            taken += subscription.handle.take_message(FootstepPlan, False) is not None
    return taken


exchange(5_000)  # buffers grow to their size
before = resident_kib()
taken = exchange(100_000)
print("messages", taken > 90_000, "grown by less than 1 MiB", resident_kib() - before < 1024)


def churn(count: int) -> None:
    for _ in range(count):
        node.destroy_publisher(node.create_publisher(FootstepPlan, "churn", 1))
        node.destroy_subscription(node.create_subscription(FootstepPlan, "churn", print, 1))
        node.destroy_service(node.create_service(AddTwoInts, "churn", lambda request, response: response))
        node.destroy_client(node.create_client(AddTwoInts, "churn"))


churn(25)
before = resident_kib()
churn(250)
# Compiled types leak about 1.2 KiB per entity in Fast DDS itself.
print("entities", "grown by less than 4 MiB", resident_kib() - before < 4096)
node.destroy_node()
rclpy.shutdown()
