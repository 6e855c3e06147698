"""`fast.py talk` publishes 100 kB at full speed; `fast.py listen` takes its time, and says what it has heard last.

`fast.py vanish` publishes a few, and is gone without a word.
"""

import os
import sys
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import ByteMultiArray

DEPTH = 5
LAST = 50 if sys.argv[1] == "vanish" else 0

rclpy.init()
node = rclpy.create_node(sys.argv[1])
try:
    if sys.argv[1] in {"talk", "vanish"}:
        publisher = node.create_publisher(ByteMultiArray, "load", DEPTH)
        message = ByteMultiArray(data=[b"x"] * 100_000)
        number = 0
        while rclpy.ok():
            number += 1
            message.layout.data_offset = number
            publisher.publish(message)
            if number == LAST:
                os._exit(3)
    else:
        burst: list[int] = []
        node.create_subscription(ByteMultiArray, "load", lambda m: burst.append(m.layout.data_offset), DEPTH)
        while rclpy.ok():
            time.sleep(0.5)
            burst.clear()
            before = time.monotonic()
            while len(burst) < DEPTH and time.monotonic() - before < 0.1:
                rclpy.spin_once(node, timeout_sec=0)
            print("heard", *burst, flush=True)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
except Exception:
    if rclpy.ok():  # otherwise it was told to end between the question and the message
        raise
