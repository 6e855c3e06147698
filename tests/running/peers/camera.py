"""A camera, or who watches it: prints a line for each thing that it notices.

`camera.py show SIZE PERIOD COUNT WATCHERS` publishes COUNT messages of SIZE bytes once so many watch, and ends; with a
period of 0 as fast as it can. `camera.py watch PAUSE DEPTH` takes so long [s] for each, and says what it got.
"""

import resource
import sys
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import Image


def content(number: int, size: int) -> bytes:
    """What a message has in it: as many bytes, others in each."""
    return number.to_bytes(4, "little") * (size // 4)


class Camera(Node):
    """Publishes images once somebody watches."""

    def __init__(self, size: str, period: str, count: str, watchers: str) -> None:
        super().__init__("camera")
        self._size, self._period, self._count = int(size), float(period), int(count)
        self._watchers = int(watchers)
        self._images = self.create_publisher(Image, "image", 10)

    def show(self) -> None:
        """Publish them all."""
        while self._images.get_subscription_count() < self._watchers:
            rclpy.spin_once(self, timeout_sec=0.02)
        resident = _resident()
        for number in range(self._count):
            self._images.publish(Image(width=number, data=content(number, self._size)))
            if self._period:
                time.sleep(self._period)
        print("shown", self._count, "grown", _resident() - resident, flush=True)


class Watcher(Node):
    """Checks what comes."""

    def __init__(self, pause: str, depth: str) -> None:
        super().__init__("watcher")
        self._pause = float(pause)
        self._got = self._last = 0
        self.create_subscription(Image, "image", self._watch, int(depth))

    def _watch(self, image: Image) -> None:
        self._got += 1
        if bytes(image.data) != content(image.width, len(image.data)):
            print("broken", image.width, flush=True)
        if image.width <= self._last and image.width:
            print("not in order", image.width, flush=True)
        self._last = image.width
        print("number", image.width, "got", self._got, "resident", _resident(), flush=True)
        time.sleep(self._pause)


def _resident() -> int:
    """The most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000


rclpy.init()
role, *words = sys.argv[1:]
node = Camera(*words) if role == "show" else Watcher(*words)
try:
    if isinstance(node, Camera):
        node.show()
    print("ready", flush=True)
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
