"""`ifgen run --lockstep`: programs in processes of their own, with one virtual time."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

TALKER = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data="Hello")))
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("bye", flush=True)
"""
LISTENER = """
import sys, time
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("listener")
heard = []
node.create_subscription(String, "chatter", heard.append, 10)
while len(heard) < int(sys.argv[1]):
    rclpy.spin_once(node)
print(time.monotonic(), [message.data for message in heard], flush=True)
assert len(heard) < 3, "too many"
"""


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    (folder / "talker.py").write_text(TALKER)
    (folder / "listener.py").write_text(LISTENER)
    command = [sys.executable, "-m", "ifgen", "run", "--lockstep", *words]
    return subprocess.run(
        command, cwd=folder, env={**os.environ}, capture_output=True, text=True, timeout=60, check=False
    )


def test_programs_share_virtual_time_until_the_last_one_ends(tmp_path: Path) -> None:
    done = run(tmp_path, "talker.py", ":", "listener.py", "2")
    assert (done.returncode, done.stdout, done.stderr) == (0, "1.0 ['Hello', 'Hello']\nbye\n", "")


def test_a_program_that_fails_ends_all(tmp_path: Path) -> None:
    done = run(tmp_path, "listener.py", "3", ":", "talker.py")
    why = "listener.py ended the run at 1.500 s: it raised AssertionError: too many"
    assert done.returncode == 1
    assert done.stderr.splitlines()[:2] == [
        "Traceback (most recent call last):",
        f'  File "{tmp_path}/listener.py", line 12, in <module>',
    ]
    assert done.stderr.splitlines()[-2:] == [f"talker.py: the run has ended: {why}", f"ifgen: {why}"]


def test_the_real_rclpy_has_none(tmp_path: Path) -> None:
    done = run(tmp_path, "--transport", "rclpy", "talker.py")
    assert (done.returncode, done.stderr.splitlines()[0]) == (
        2,
        "error[no-transport]: the real rclpy has no lockstep",
    )
