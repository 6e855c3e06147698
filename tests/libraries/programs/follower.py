"""A robot that follows another one, in the way of the tutorials of tf2."""

import math
import sys

import rclpy
import tf2_geometry_msgs
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster
from tf2_ros.transform_listener import TransformListener


class Leader(Node):
    """Drives in a circle of 2 m, a quarter of it per second of its own time, with a camera in front."""

    def __init__(self):
        super().__init__("leader")
        self.broadcaster = TransformBroadcaster(self)
        self.static_broadcaster = StaticTransformBroadcaster(self)
        camera = TransformStamped()
        camera.header.stamp = self.get_clock().now().to_msg()
        camera.header.frame_id = "leader"
        camera.child_frame_id = "camera"
        camera.transform.translation.x = 0.2
        self.static_broadcaster.sendTransform(camera)
        self.timer = self.create_timer(0.02, self.drive)
        self.tenths = 10

    def drive(self):
        if not self.broadcaster.pub_tf.get_subscription_count():
            return
        t = TransformStamped()
        t.header.stamp.sec, tenth = divmod(self.tenths, 10)
        t.header.stamp.nanosec = tenth * 100_000_000
        t.header.frame_id = "world"
        t.child_frame_id = "leader"
        angle = self.tenths * 0.1 * math.pi / 2
        t.transform.translation.x = 2.0 * math.cos(angle)
        t.transform.translation.y = 2.0 * math.sin(angle)
        t.transform.rotation.z = math.sin(angle / 2)
        t.transform.rotation.w = math.cos(angle / 2)
        self.broadcaster.sendTransform(t)
        self.tenths += 1


class Follower(Node):
    """Says where it sees what the camera of the leader sees, each second, four times."""

    def __init__(self):
        super().__init__("follower")
        self.tf_buffer = Buffer()
        self.tf_listener = TransformListener(self.tf_buffer, self)
        self.seconds = 2
        self.timer = self.create_timer(0.01, self.look)

    def look(self):
        seen = tf2_geometry_msgs.PointStamped()
        seen.header.frame_id = "camera"
        seen.header.stamp.sec = self.seconds
        seen.point.x = 0.8
        try:
            place = self.tf_buffer.transform(seen, "world").point
        except TransformException:
            return
        print(f"after {self.seconds} s: {abs(place.x):.3f} {abs(place.y):.3f}", flush=True)
        self.seconds += 1
        if self.seconds == 6:
            past = rclpy.time.Time(nanoseconds=500_000_000)
            try:
                self.tf_buffer.lookup_transform("world", "camera", past)
            except TransformException as error:
                print(type(error).__name__, str(error).partition("  ")[0])
            raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    nodes = [Leader(), Follower()]
    executor = rclpy.executors.SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    sys.exit(main())
