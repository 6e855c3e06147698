"""Publishes what an emulated microcontroller writes: lines `TOPIC PAYLOAD`, the payload in hexadecimal.

    make -C examples/languages/firmware
    ifgen run examples/languages/firmware/bridge.py

The payloads are those of ROS, so nothing here decodes them; the subscription does, as any other node would.
"""

import subprocess
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import Imu, JointState

EMULATOR = [
    *("qemu-system-arm", "-M", "microbit", "-display", "none", "-serial", "none", "-monitor", "none"),
    *("-chardev", "stdio,id=out", "-semihosting-config", "enable=on,target=native,chardev=out", "-kernel"),
]
FIRMWARE = Path(__file__).parent / "build" / "firmware.elf"
TYPES = {"imu": Imu, "joint_states": JointState}


def main() -> None:
    """Publish each payload, and print what a subscription gets."""
    rclpy.init()
    node = rclpy.create_node("bridge")
    received = []
    node.create_subscription(
        Imu, "imu", lambda m: received.append(f"{m.header.frame_id} {m.linear_acceleration.z}"), 10
    )
    node.create_subscription(
        JointState, "joint_states", lambda m: received.append(f"{list(m.name)} {list(m.position)}"), 10
    )
    publishers = {topic: node.create_publisher(cls, topic, 10) for topic, cls in TYPES.items()}
    lines = subprocess.run(
        [*EMULATOR, str(FIRMWARE)], capture_output=True, text=True, timeout=60, check=True
    ).stdout
    for line in lines.splitlines():
        topic, payload = line.split()
        publishers[topic].publish(bytes.fromhex(payload))
    try:
        while len(received) < len(lines.splitlines()):
            rclpy.spin_once(node, timeout_sec=5)
    except ExternalShutdownException:
        return
    print(*received, sep="\n")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
