"""A value that the wire cannot hold: the caller of publish receives the original error, with the path."""

from common import rclpy
from humanoid_interfaces.msg import EmergencyStop, Footstep, FootstepPlan
from humanoid_interfaces.srv import AddTwoInts

rclpy.init()
node = rclpy.create_node("wrong_value")
publisher = node.create_publisher(FootstepPlan, "plan", 10)
stops = node.create_publisher(EmergencyStop, "stop", 10)
client = node.create_client(AddTwoInts, "add")
for send in (
    lambda: publisher.publish(FootstepPlan(steps=[Footstep(index=-1)])),
    lambda: publisher.publish("plan"),
    lambda: client.call_async(AddTwoInts.Request(a="2")),
    lambda: stops.publish(EmergencyStop(source="bad \ud83d")),
):
    try:
        send()
    except Exception as error:
        print(type(error).__name__, error, *getattr(error, "__notes__", ()))
publisher.publish(FootstepPlan())
print("goes on")
node.destroy_node()
rclpy.shutdown()
