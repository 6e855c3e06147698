"""Uses everything that a process has only once, under the names that the other programs use, silently."""

import asyncio
import atexit
import io
import logging
import os
import random
import signal
import sys
import threading
from pathlib import Path

import helper
import rclpy

os.environ["PYTHON_BASIC_REPL"] = "1"  # shared by all, which is known to be harmless
assert helper.WHO == "bystander"
sys.argv = ["nobody", "--ros-args", "--log-level", "fatal"]
sys.path[:0] = ["nowhere", str(Path(__file__).parent / "nowhere_either")]
sys.excepthook = lambda *_: None
threading.excepthook = lambda *_: None
atexit.register(lambda: None)
logging.basicConfig(level=logging.CRITICAL, format="BYSTANDER %(message)s", stream=sys.stderr)
for name in ("robot", "asyncio", "helper"):
    heard = logging.StreamHandler(sys.stderr)
    heard.setFormatter(logging.Formatter("BYSTANDER %(message)s"))
    logging.getLogger(name).addHandler(heard)
    logging.getLogger(name).setLevel(logging.CRITICAL)
logging.disable(logging.ERROR)
sys.stdout = io.StringIO()
print("nobody sees this")

rclpy.init(args=sys.argv)
node = rclpy.create_node("bystander")
over = threading.Event()


def end(number, frame):
    over.set()
    rclpy.try_shutdown()


signal.signal(signal.SIGINT, end)
signal.signal(signal.SIGTERM, end)


class Message:
    """Another class of this name in another `__main__`."""


async def idle():
    while not over.is_set():
        await asyncio.sleep(0.01)


worker = threading.Thread(target=lambda: asyncio.run(idle()))
worker.start()
if "WAIT_FOR" in os.environ:
    Path(os.environ["WAIT_FOR"]).touch()
while not over.is_set():
    random.seed(0)
    os.chdir("/")
    over.wait(0.01)
worker.join()
