"""Pairs images with ranges, in the way of the tutorials of message_filters."""

import message_filters
import rclpy
from builtin_interfaces.msg import Time
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image, Range


class Sensors(Node):
    """A camera at 10 Hz, and a range finder whose times are 20 ms later and which misses every third one."""

    def __init__(self):
        super().__init__("sensors")
        self.images = self.create_publisher(Image, "image", 10)
        self.ranges = self.create_publisher(Range, "range", 10)
        self.timer = self.create_timer(0.01, self.measure)
        self.count = 0

    def measure(self):
        if not (self.images.get_subscription_count() and self.ranges.get_subscription_count()):
            return
        image, distance = Image(width=self.count), Range(range=0.1 * self.count)
        image.header.stamp = Time(sec=1 + self.count // 10, nanosec=self.count % 10 * 100_000_000)
        distance.header.stamp = Time(
            sec=1 + self.count // 10, nanosec=self.count % 10 * 100_000_000 + 20_000_000
        )
        self.images.publish(image)
        if self.count % 3 != 2:
            self.ranges.publish(distance)
        self.count += 1


class Fusion(Node):
    """Says which image and which range belong together, and ends after six."""

    def __init__(self):
        super().__init__("fusion")
        self.image_sub = message_filters.Subscriber(self, Image, "image", qos_profile=QoSProfile(depth=10))
        self.range_sub = message_filters.Subscriber(self, Range, "range")
        self.cache = message_filters.Cache(self.range_sub, cache_size=100)
        self.sync = message_filters.ApproximateTimeSynchronizer(
            [self.image_sub, self.range_sub], queue_size=10, slop=0.05
        )
        self.sync.registerCallback(self.fuse)
        self.count = 0

    def fuse(self, image, distance):
        print(f"image {image.width} belongs to {distance.range:.1f} m at {distance.header.stamp.nanosec} ns")
        self.count += 1
        if self.count == 6:
            oldest = self.cache.getOldestTime().to_msg()
            print(f"the cache of {self.range_sub.getTopic()} begins at {oldest.sec}.{oldest.nanosec:09} s")
            raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    executor = rclpy.executors.SingleThreadedExecutor()
    for node in (Fusion(), Sensors()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException, SystemExit):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
