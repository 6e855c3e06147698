"""Nodes with two versions of many types meet, one pair after the other: `pairs.py old|new CORPUS`.

`old` publishes a message of each pair, and `new` subscribes to it. A line on standard input names the next pair;
for `old`, another one ends it. `new` answers with what it has heard and received, as JSON.
"""

import json
import sys
import threading
import time
from functools import partial
from pathlib import Path

import ifgen.dynamic
import rclpy
from ifgen_runtime import to_dict
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.field_types import Basic, Text, fields_of
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import explanation
from rclpy.executors import SingleThreadedExecutor

role, corpus = sys.argv[1:]
LIMIT, AFTERWARDS = 20.0, 0.25  # [s]
pairs = json.loads(Path(corpus).read_text())


def version(pair, which):
    name, text = f"edited_msgs/msg/{pair['name']}", pair[which]
    if not pair["nested"]:
        return ifgen.dynamic.class_from_text(name, text)
    others = {name: text}
    return ifgen.dynamic.class_from_text(
        f"{name}Holder", f"bool flag\n{pair['name']}[] held\n", others=others
    )


def filled(cls):
    """A message with a value in each field that is not that field's default."""
    return cls(**{field.slot.removeprefix("_"): value(field) for field in fields_of(cls)})


def value(field):
    if isinstance(field.type, Text):
        one = "a"
    elif not isinstance(field.type, Basic):
        one = filled(field.type)
    else:
        one = {"boolean": True, "octet": b"\x07"}.get(field.type.name, 0.5 if field.type.is_float else 3)
    if field.size is not None:
        return [one] * field.size
    return [one] if field.is_sequence else one


def upgraded(message, new):
    """Keep the fields that have the same name and type in both."""
    types, made = message.get_fields_and_field_types(), new()
    for field in fields_of(new):
        if types.get(field.name) != new.get_fields_and_field_types()[field.name]:
            continue
        found = getattr(message, field.name)
        if isinstance(field.type, type):
            of = field.type
            found = [upgraded(one, of) for one in found] if field.is_collection else upgraded(found, of)
        setattr(made, field.name, found)
    return made


class Pair:
    """Two versions of a type on a topic of their own."""

    def __init__(self, number):
        pair = pairs[number]
        self.topic, self.is_same = f"/pair_{number}", pair["same"]
        self.old, self.new = version(pair, "before"), version(pair, "after")
        self.message = filled(self.old)

    def publish(self, node):
        """Publish from now on; returns a function that ends it."""
        publisher = node.create_publisher(self.old, self.topic, 10)
        timer = node.create_timer(0.02, lambda: publisher.publish(self.message))
        return lambda: (node.destroy_timer(timer), node.destroy_publisher(publisher))

    def listen(self, node):
        """Wait for the warning, or for a message if there is none to expect, and then for a little longer."""
        if not self.is_same:
            register(Adapter(self.old, self.new, partial(upgraded, new=self.new)))
        met, heard, received = None, [], []
        reporting.listener = lambda mismatch: heard.append((time.monotonic(), mismatch))
        subscription = node.create_subscription(self.new, self.topic, received.append, 10)
        until = end = time.monotonic() + LIMIT
        while (now := time.monotonic()) < until:
            executor.spin_once(timeout_sec=0.01)
            if met is None and node.count_publishers(self.topic):
                met = now
            if until == end and (heard or (received and self.is_same)):
                until = time.monotonic() + AFTERWARDS
        node.destroy_subscription(subscription)
        expected = to_dict(upgraded(self.message, self.new))
        return {
            "delays": [max(0.0, moment - (met or now)) for moment, _ in heard],
            "texts": [explanation(mismatch) for _, mismatch in heard],
            "received": len(received),
            "garbage": [to_dict(message) for message in received if to_dict(message) != expected],
        }


rclpy.init()
node = rclpy.create_node("talker" if role == "old" else "listener")
executor = SingleThreadedExecutor()
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
if role == "old":
    spinning.start()
for line in iter(sys.stdin.readline, ""):
    pair = Pair(int(line))
    if role == "new":
        print(json.dumps(pair.listen(node)), flush=True)
        continue
    end = pair.publish(node)
    sys.stdin.readline()  # the listener has done with it
    end()
executor.shutdown()
if role == "old":
    spinning.join()  # real rclpy aborts if Python ends under it
rclpy.shutdown()
