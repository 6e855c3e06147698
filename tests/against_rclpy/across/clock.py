"""`/clock` of one process, and nodes of another one that live by it."""

from rclpy.clock import ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import QoSProfile
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from stage import Stage
from std_msgs.msg import Float64


def timekeeper(stage: Stage) -> None:
    """Publishes the time, as fast as it is asked to."""
    node = stage.node("timekeeper")
    publisher = node.create_publisher(Clock, "/clock", 10)
    asked = []
    node.create_subscription(Float64, "tick", lambda message: asked.append(message.data), 10)
    stage.until(publisher.get_subscription_count)
    stage.until(lambda: node.count_publishers("tick"))
    stage.meet()
    while True:
        stage.until(lambda: asked, "a tick")
        seconds = asked.pop()
        if seconds < 0:
            break
        publisher.publish(Clock(clock=Time(nanoseconds=round(seconds * 1e9)).to_msg()))
    stage.meet()


def follower(stage: Stage) -> None:
    """Lives by it."""
    use_sim_time = Parameter("use_sim_time", value=True)
    node = stage.node("follower", parameter_overrides=[use_sim_time])
    clock = node.get_clock()
    asking = node.create_publisher(Float64, "tick", QoSProfile(depth=10))
    stage.until(lambda: asking.get_subscription_count() and node.count_publishers("/clock"))
    stage.spin(0.3)
    stage.meet()
    jumps, ticks = [], []
    threshold = JumpThreshold(
        min_forward=Duration(seconds=5), min_backward=Duration(nanoseconds=-1), on_clock_change=True
    )
    handle = clock.create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append((int(jump.clock_change), jump.delta.nanoseconds))
    )
    node.create_timer(1.0, lambda: ticks.append(clock.now().nanoseconds))
    stage.say(clock.clock_type == ClockType.ROS_TIME, clock.ros_time_is_active, clock.now().nanoseconds)

    def become(seconds):
        asking.publish(Float64(data=seconds))
        stage.until(lambda: clock.now().nanoseconds == round(seconds * 1e9), f"{seconds} s")
        stage.spin(0.05)
        stage.say(seconds, ticks, jumps)

    for seconds in (1.1, 1.6, 2.2, 3.25, 3.5, 20.1, 20.2, 4.5, 5.75):
        become(seconds)
    handle.unregister()
    client = AsyncParameterClient(node, "follower")
    stage.until(client.services_are_ready)
    (result,) = stage.result(client.set_parameters([Parameter("use_sim_time", value=False)])).results
    stage.say(result.successful, clock.ros_time_is_active, clock.now().nanoseconds > 1e18)
    asking.publish(Float64(data=-1.0))
    stage.meet()


ROLES = {
    "timekeeper": timekeeper,
    "follower": follower,
}
