"""Large arrays that are sent: what their owner may do meanwhile, two contexts, and exit in the middle of it."""

import ctypes
import sys
import threading
from array import array
from typing import Any

import rclpy
from common import never_compiled, spin_until
from ifgen_runtime import SerializationError, serialize
from ifgen_runtime.codec.choice import chosen
from large_msgs.msg import Many
from rclpy.serialization import deserialize_message, serialize_message

Image = never_compiled("sensor_msgs/msg/Image")
SIZE = 200_000


def image(value: int) -> Any:
    return Image(encoding="mono8", height=1, width=SIZE, step=SIZE, data=bytes([value]) * SIZE)


def function(cls: type, capsule: str, result: Any, *arguments: Any) -> Any:
    get_pointer = ctypes.pythonapi.PyCapsule_GetPointer
    get_pointer.restype, get_pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return ctypes.PYFUNCTYPE(result, *arguments)(get_pointer(getattr(type(cls), capsule), None))


def resize(values: Any) -> str:
    try:
        values.append(0)
    except BufferError:
        return "held"
    values.pop()
    return "free"


def arrays_are_held_from_conversion_to_the_end() -> None:
    """What rclpy calls, one by one, since it lets nobody in between."""
    deserialize_message(serialize(image(0)), Image)  # so that rclpy asks for type support
    create = function(Image, "_CREATE_ROS_MESSAGE", ctypes.c_void_p)
    convert = function(Image, "_CONVERT_FROM_PY", ctypes.c_bool, ctypes.py_object, ctypes.c_void_p)
    destroy = function(Image, "_DESTROY_ROS_MESSAGE", None, ctypes.c_void_p)
    sent = image(1)
    message = create()
    steps = [convert(sent, message), resize(sent.data), convert(image(2), message), resize(sent.data)]
    convert(sent, message)
    destroy(message)
    print("held", *steps, resize(sent.data))


def bytes_are_those_of_the_codec() -> None:
    """More arrays than a message lends to DDS, and sizes around alignments."""
    wrong = []
    for size in (4_096, 4_097, 5_001, 40_003):
        message = Many(tail="x", **{f"values_{n}": array("B", bytes([n]) * (size + n)) for n in range(10)})
        if serialize_message(message) != serialize(message):
            wrong.append(size)
        if deserialize_message(serialize_message(message), Many) != message:
            wrong.append(-size)
    print("bytes", wrong)


def errors_come_from_the_codec_and_leave_nothing() -> None:
    sent = image(1)
    sent.step = -1
    try:
        serialize_message(sent)
    except SerializationError as error:
        print("error", error, resize(sent.data))
    sent.step = 1
    print("goes on", deserialize_message(serialize_message(sent), Image) == sent)


def nobody_gets_half_an_image() -> None:
    sys.setswitchinterval(1e-5)
    node = rclpy.create_node("sending")
    torn, errors = [], []

    def check(message: Any) -> None:
        if len(message.data) != SIZE or len(set(message.data[:: SIZE // 50])) != 1:
            torn.append(message)

    subscription = node.create_subscription(Image, "images", check, 10)
    publisher = node.create_publisher(Image, "images", 10)
    spin_until(node, publisher.get_subscription_count)
    sent = image(0)
    stop = threading.Event()

    def change() -> None:
        value = 0
        while not stop.is_set():
            value = (value + 1) % 256
            try:
                sent.data[:] = array("B", bytes([value]) * SIZE)
                sent.data = bytes([value]) * SIZE
            except Exception as error:
                errors.append(repr(error))

    changer = threading.Thread(target=change)
    changer.start()
    for _ in range(300):
        publisher.publish(sent)
        rclpy.spin_once(node, timeout_sec=0)
    stop.set()
    changer.join()
    print("torn", len(torn), errors[:1])
    node.destroy_subscription(subscription)
    node.destroy_node()


def two_contexts() -> None:
    nodes = []
    for number in range(2):
        context = rclpy.Context()
        context.init()
        nodes.append(rclpy.create_node(f"node_{number}", context=context))
    publishers = {n: node.create_publisher(Image, f"context_{n}", 10) for n, node in enumerate(nodes)}
    received: list[list[Any]] = [[], []]
    executors = []
    for n, node in enumerate(nodes):
        node.create_subscription(Image, f"context_{n}", received[n].append, 10)
        executors.append(rclpy.executors.SingleThreadedExecutor(context=node.context))
        executors[n].add_node(node)
    for round_ in range(5):
        for n, publisher in publishers.items():
            while len(received[n]) <= round_:
                publisher.publish(image(10 * n + round_))
                executors[n].spin_once(timeout_sec=0.1)
            del received[n][round_ + 1 :]
        if round_ == 2:  # the other one goes on
            rclpy.shutdown(context=nodes[0].context)
            del publishers[0]
    print("contexts", [[message.data[0] for message in messages] for messages in received])
    nodes[1].context.shutdown()


def leave_while_images_are_sent() -> None:
    node = rclpy.create_node("leaving")
    received: list[Any] = []
    node.create_subscription(Image, "leaving", received.append, 10)
    publisher = node.create_publisher(Image, "leaving", 10)
    spin_until(node, publisher.get_subscription_count)

    def publish() -> None:
        while True:
            publisher.publish(image(3))

    threading.Thread(target=publish, daemon=True).start()
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while len(received) < 3:
        threading.Event().wait(0.01)
    print("leaving", flush=True)


rclpy.init()
print("codec", chosen().name)
arrays_are_held_from_conversion_to_the_end()
bytes_are_those_of_the_codec()
errors_come_from_the_codec_and_leave_nothing()
nobody_gets_half_an_image()
two_contexts()
leave_while_images_are_sent()
