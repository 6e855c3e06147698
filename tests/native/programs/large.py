"""Large sequences of received messages: what they hold, who shares memory with whom, and how much of it stays."""

import gc
import sys
import threading
import weakref
from array import array
from collections.abc import Callable
from typing import Any

import rclpy
from common import never_compiled, resident_kib, spin_until
from ifgen_runtime import serialize
from large_msgs import msg
from rclpy.serialization import deserialize_message

Image = never_compiled("sensor_msgs/msg/Image")
SIZES = (40_000, 40_001, 40_007, 40_003)


def address(values: Any) -> int:
    return int(values.buffer_info()[0])


def sent(cls: Any, size: int, seed: int) -> Any:
    message = cls(head="x" * (seed % 7), before=seed % 100, after=0.1 * seed, tail="y" * (seed % 5))
    code = message.values.typecode
    raw = bytes((seed + n) % 251 for n in range(251)) * (size * message.values.itemsize // 251 + 1)
    if code in "fd":
        message.values = array(code, [0.5 * (n + seed) for n in range(size)])
    else:
        message.values = array(code, raw[: size * message.values.itemsize])
    return message


def taken(message: Any) -> Any:
    return deserialize_message(serialize(message), type(message))


def all_types_and_alignments() -> None:
    """Each message twice: its array is new, then one that waited."""
    wrong = []
    for name in msg.__all__:
        if not name.startswith("Of"):
            continue
        cls = getattr(msg, name)
        for size in SIZES:
            for seed in range(3):
                message = sent(cls, size, seed)
                if (got := taken(message)) != message or type(got.values) is not array:
                    wrong.append((name, size, seed))
                del got
    print("types", wrong)


def memory_is_used_again_only_when_nobody_has_it() -> None:
    cls = msg.OfUint8
    messages = [sent(cls, 50_000, seed) for seed in range(8)]
    one = weakref.ref(taken(messages[0]).values)
    print("again", taken(messages[1]).values is one())
    kept = [taken(message) for message in messages]
    print("kept", kept == messages, len({address(message.values) for message in kept}))
    view = memoryview(kept.pop().values)
    array_only = kept.pop().values
    del kept
    for message in messages[:6] * 3:
        taken(message)
    print("views", view == memoryview(messages[7].values), array_only == messages[6].values)


def users_may_change_what_they_got() -> None:
    cls = msg.OfUint8
    for change in (lambda a: a.append(1), lambda a: a.pop(), lambda a: a.__delitem__(slice(None))):
        got = taken(sent(cls, 60_000, 1))
        change(got.values)
        del got
        other = sent(cls, 60_000, 2)
        print("changed", taken(other) == other, taken(other) == other)


def nested_sequences() -> None:
    cls = msg.Pair
    for seed in range(4):
        left, right = sent(msg.OfUint8, 40_000 + seed, seed), sent(msg.OfUint16, 30_000, seed)
        message = cls(left=left, right=right)
        print("nested", taken(message) == message)


def broken_payloads() -> None:
    """What is refused leaves the arrays that wait as they are."""
    cls = msg.OfFloat64
    message = sent(cls, 40_000, 1)
    data = serialize(message)
    refused = 0
    for _ in range(3):
        taken(message)
        try:
            deserialize_message(data[: len(data) // 2], cls)
        except Exception:
            refused += 1
    print("broken", refused, taken(message) == message)


def threads() -> None:
    cls = msg.OfUint8
    sys.setswitchinterval(1e-5)
    messages = [sent(cls, 40_000, seed) for seed in range(4)]
    wrong: list[int] = []

    def work(number: int) -> None:
        held = []
        for _ in range(300):
            got = taken(messages[number])
            held = [*held[-number:], got] if number else []
            if got != messages[number] or any(kept != messages[number] for kept in held):
                wrong.append(number)

    workers = [threading.Thread(target=work, args=(number,)) for number in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    print("threads", wrong)


def grown_by(work: Callable[[], None]) -> int:
    """How much more memory there is [MiB]."""
    work()
    gc.collect()
    before = resident_kib()
    work()
    gc.collect()
    return (resident_kib() - before) // 1024


def memory() -> None:
    cls = msg.OfUint8
    message = cls(values=bytes(24 << 20))

    arrays = []
    for size in range(8):
        message.values = message.values[: (24 << 20) - 4096 * size]
        arrays.append(weakref.ref(taken(message).values))
    print("waiting", [size for size, array in enumerate(arrays) if array() is not None])
    node = rclpy.create_node("large")
    publisher = node.create_publisher(Image, "image", 10)
    subscription = node.create_subscription(Image, "image", lambda message: None, 10)
    spin_until(node, publisher.get_subscription_count)
    image = Image(height=480, width=640, step=1920, data=bytes(640 * 480 * 3))

    def publish() -> None:
        for _ in range(5_000):
            publisher.publish(image)
            with subscription.handle:
                assert subscription.handle.take_message(Image, False) is not None

    print("publishes", grown_by(publish) < 2)
    node.destroy_node()


rclpy.init()
all_types_and_alignments()
memory_is_used_again_only_when_nobody_has_it()
users_may_change_what_they_got()
nested_sequences()
broken_payloads()
threads()
memory()
rclpy.shutdown()
