"""One end of a cable that loses packets: `cable.py DESCRIPTOR DELAY LOSS SEED`, on the machine that it is plugged into.

The other end holds the other half of the socket. What this machine sends arrives there after DELAY [s], and the share
LOSS of it never. Programs notice nothing of this but the network: the kernel repeats what TCP misses.
"""

import fcntl
import os
import random
import select
import socket
import struct
import sys
import time
from collections import deque
from contextlib import suppress

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000  # linux/if_tun.h
LARGEST = 65536  # [bytes] of a packet


def plugged_in(name: bytes) -> int:
    """Make a network device; each packet that is sent to it can be read, and what is written arrives there."""
    device = os.open("/dev/net/tun", os.O_RDWR)
    fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH", name, IFF_TUN | IFF_NO_PI))
    return device


def carry(device: int, other_end: socket.socket, delay: float, loss: float, draw: random.Random) -> None:
    """Pass packets on, both ways, until the other end is gone."""
    on_its_way: deque[tuple[float, bytes]] = deque()
    while True:
        wait = max(on_its_way[0][0] - time.monotonic(), 0.0) if on_its_way else None
        ready = select.select([device, other_end], [], [], wait)[0]
        if device in ready:
            packet = os.read(device, LARGEST)
            if draw.random() >= loss:
                on_its_way.append((time.monotonic() + delay, packet))
        if other_end in ready:
            packet = other_end.recv(LARGEST)
            if not packet:
                return
            with suppress(OSError):  # switched off, as `ip link set cable down` does
                os.write(device, packet)
        while on_its_way and on_its_way[0][0] <= time.monotonic():
            other_end.send(on_its_way.popleft()[1])


device = plugged_in(b"cable")
print("ready", flush=True)
carry(
    device,
    socket.socket(fileno=int(sys.argv[1])),
    float(sys.argv[2]),
    float(sys.argv[3]),
    random.Random(int(sys.argv[4])),
)
