"""A peer that is no ROS and sends whatever it likes: `hostile.py DOMAIN FOLDER HASH TOKENS`.

It goes for everybody who has a socket in FOLDER, as fast as it can, until it is killed. HASH is that of
std_msgs/msg/Int64, so that some of what it sends is addressed to real endpoints.
"""

import json
import random
import sys
import threading
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

import zenoh
from zenoh.handlers import Callback

DOMAIN, FOLDER, HASH, TOKENS = sys.argv[1], Path(sys.argv[2]), sys.argv[3], int(sys.argv[4])
OTHER_HASH = f"RIHS01_{'0' * 64}"
TYPE = "std_msgs::msg::dds_::Int64_"
PAYLOADS: tuple[Callable[[], bytes], ...] = (
    bytes,
    lambda: b"\0\1\0\0" + bytes(8),  # a number
    lambda: b"\0\1\0\0" + b"\xff" * 16,  # lengths without end
    lambda: b"\0\1\0\0" + draw.randbytes(draw.randrange(300)),
    lambda: b"cos\nsystem\n(S'touch /tmp/ifgen-was-here'\ntR.",  # a pickle that runs a command
    lambda: draw.randbytes(100_000),
)
ATTACHMENTS: tuple[Callable[[], bytes | None], ...] = (
    lambda: None,
    bytes,
    lambda: draw.randbytes(33),
    lambda: draw.randbytes(32),
    lambda: draw.randbytes(16) + b"\x10" + draw.randbytes(16),
    lambda: bytes(77),
    lambda: draw.randbytes(5000),
)
PARTS = ("x", "%", "%%", "a b", "9", "\x1b[2J", "\n", "é" * 50, "%count", "MP", "-1", "9" * 30, "q" * 5000)
draw = random.Random(1)
sent = {"tokens": 0, "messages": 0, "requests": 0, "answers": 0}


def payload() -> bytes:
    return draw.choice(PAYLOADS)()


def attachment() -> bytes | None:
    return draw.choice(ATTACHMENTS)()


def token(number: int) -> str:
    """A node or an endpoint that is not there; now and then nothing at all."""
    kind = draw.choice(("MP", "MS", "NN", "SS", "SC"))
    parts = ["@ros2_lv", DOMAIN, "bad", "0", str(number), kind, "%", "%", f"bad{number % 100}"]
    if kind in {"MP", "MS"}:
        parts += [
            draw.choice(("%count", f"%t{number}")),
            TYPE,
            draw.choice((HASH, OTHER_HASH)),
            "::,10:,:,:,,",
        ]
    elif kind != "NN":
        parts += [
            "%t%get_parameters",
            "rcl_interfaces::srv::dds_::GetParameters_",
            OTHER_HASH,
            "::,10:,:,:,,",
        ]
    if draw.random() < 0.3:
        parts[draw.randrange(2, len(parts))] = draw.choice(PARTS)
    return "/".join(parts)


def announce(session: zenoh.Session) -> None:
    """Hold many tokens, and exchange one after the other for new ones."""
    held: list[zenoh.LivelinessToken] = []
    for number in count():
        try:
            held.append(session.liveliness().declare_token(token(number)))
        except zenoh.ZError:
            continue  # no key of Zenoh
        sent["tokens"] += 1
        if len(held) > TOKENS:
            held.pop(draw.randrange(TOKENS)).undeclare()


def publish(session: zenoh.Session) -> None:
    keys = (f"{DOMAIN}/count/{TYPE}/{HASH}", f"@ifgen_alive/{DOMAIN}/zz", f"@ifgen_alive/{DOMAIN}/{'0' * 32}")
    while True:
        session.put(draw.choice(keys), payload(), attachment=attachment())
        sent["messages"] += 1


def ask(session: zenoh.Session) -> None:
    def ignore(_: zenoh.Reply) -> None: ...

    while True:
        data = {"payload": payload()} if draw.random() < 0.9 else {}
        handler = Callback(ignore, indirect=False)
        target = zenoh.QueryTarget.ALL
        session.get(f"{DOMAIN}/**", handler, attachment=attachment(), timeout=1.0, target=target, **data)
        sent["requests"] += 1


def serve(session: zenoh.Session) -> None:
    """Answer everything that anybody asks, several times."""

    def answer(query: zenoh.Query) -> None:
        for _ in range(3):
            query.reply(query.key_expr, payload(), attachment=attachment())
            sent["answers"] += 1

    session.declare_queryable(f"{DOMAIN}/**", Callback(answer, indirect=False))
    while True:
        time.sleep(1.0)


config = zenoh.Config()
doors = [f"unixsock-stream/{path.with_suffix('.zenoh')}" for path in FOLDER.glob("*.bell")]
config.insert_json5("scouting/multicast/enabled", "false")
config.insert_json5("listen/endpoints", "[]")
config.insert_json5("connect/endpoints", json.dumps(doors))
for work in (announce, publish, ask, serve):  # a session each: none holds up another
    threading.Thread(target=work, args=(zenoh.open(config),), daemon=True).start()
while True:
    time.sleep(1.0)
    print("sent", *sent.values(), flush=True)
