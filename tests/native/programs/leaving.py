"""Exit while another thread spins and messages are under way; a forked child exits first."""

import os
import threading

from common import rclpy, spin_until
from humanoid_interfaces.msg import FootstepPlan

child = os.fork()
if child == 0:
    os._exit(0)
os.waitpid(child, 0)
rclpy.init()
node = rclpy.create_node("leaving")
received = []
node.create_subscription(FootstepPlan, "plan", received.append, 10)
publisher = node.create_publisher(FootstepPlan, "plan", 10)
spin_until(node, publisher.get_subscription_count)
publisher.publish(FootstepPlan())
spin_until(node, lambda: received)
child = os.fork()
if child == 0:  # has our classes, and no threads of DDS
    assert FootstepPlan.__deserialize__(FootstepPlan().__serialize__()) == FootstepPlan()
    os._exit(7)
print("child", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
for _ in range(100):
    publisher.publish(FootstepPlan())
print("leaving", flush=True)
