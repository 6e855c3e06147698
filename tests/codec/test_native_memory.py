"""The codec in C keeps no references, loses no memory, and stands threads, collections and odd classes."""

from __future__ import annotations

import gc
import sys
import threading
import tracemalloc
from array import array
from contextlib import suppress
from typing import Any

import pytest
from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec.choice import chosen

from .support import Classes

NATIVE: Any = chosen().extension
pytestmark = pytest.mark.skipif(NATIVE is None, reason=f"the codec in C does not run: {chosen().reason}")

NAMES = ["Arrays", "Bounds", "Deep", "Letters", "Sequences", "Shifting", "Wide", "Words"]


def filled(classes: Classes) -> list[Any]:
    """Messages with something in them, for every kind of field."""
    sequences, words = classes["codec_msgs/msg/Sequences"], classes["codec_msgs/msg/Words"]
    path, pose = classes["nav_msgs/msg/Path"], classes["geometry_msgs/msg/PoseStamped"]
    image = classes["sensor_msgs/msg/Image"]
    return [
        *(classes[f"codec_msgs/msg/{name}"]() for name in NAMES),
        sequences(doubles=[0.1] * 9, characters=range(9), raw=[b"x"], flags=[True], texts=["é", "x" * 100]),
        words(),
        path(poses=[pose() for _ in range(9)]),
        image(data=array("B", bytes(10_000))),
        classes["sensor_msgs/msg/Imu"](),
        classes["test_msgs/msg/MultiNested"](),
    ]


def test_no_memory_is_lost(classes: Classes) -> None:
    """Whole messages, broken ones in the middle of which C gives up, and objects that it cannot write."""
    cases = [(message, serialize(message), type(message)) for message in filled(classes)]
    wrong = classes["sensor_msgs/msg/JointState"](name=["a"] * 9, position=[0.1] * 600, velocity=[0.1] * 600)
    wrong._effort = [None]

    def work(rounds: int) -> None:
        for _ in range(rounds):
            for message, data, cls in cases:
                serialize(message)
                deserialize(data, cls)
                refused(deserialize, data[: len(data) * 2 // 3], cls)
            refused(serialize, wrong)

    work(5)
    gc.collect()
    tracemalloc.start()
    try:
        work(3)
        gc.collect()
        before, _ = tracemalloc.get_traced_memory()
        work(40)
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < 2000  # one object of 50 bytes lost in each round would be this much


def refused(function: Any, *arguments: Any) -> None:
    with suppress(Exception):
        function(*arguments)


def work(message: Any, data: bytes) -> None:
    serialize(message)
    deserialize(data, type(message))
    refused(deserialize, data[:-1], type(message))


@pytest.mark.slow
def test_no_references_are_kept(classes: Classes) -> None:
    for message in filled(classes):
        cls = type(message)
        data = serialize(message)
        values = [getattr(message, slot) for slot in cls.__slots__ if slot != "_check_fields"]
        # Small values are shared by the whole process.
        everything = [
            message,
            data,
            cls,
            *(v for v in values if not isinstance(v, int | str | bytes | float)),
        ]
        work(message, data)  # what is remembered of a class is made at its first use
        before = [sys.getrefcount(value) for value in everything]
        for _ in range(20):
            work(message, data)
        gc.collect()
        after = [sys.getrefcount(value) for value in everything]
        assert after == before, cls


def test_a_decoded_message_owns_what_it_holds(classes: Classes) -> None:
    for message in filled(classes):
        made = deserialize(serialize(message), type(message))
        values = [getattr(made, slot) for slot in type(message).__slots__ if slot != "_check_fields"]
        shared = (None, True, False, "", "x", b"x", 0, 0.0)
        own = [value for value in values if hasattr(value, "__len__") and not any(value is s for s in shared)]
        own = [value for value in own if not isinstance(value, str | bytes)]
        assert all(gc.is_tracked(value) for value in own if isinstance(value, list))
        del values
        assert {sys.getrefcount(value) for value in own} <= {4}  # slot, `own`, the loop's name, the argument


def test_no_collection_in_the_middle(classes: Classes) -> None:
    """The collector stays off while C reads, and is as it was afterwards."""
    path, pose = classes["nav_msgs/msg/Path"], classes["geometry_msgs/msg/PoseStamped"]
    data = serialize(path(poses=[pose() for _ in range(3000)]))
    collections: list[str] = []
    thresholds, enabled = gc.get_threshold(), gc.isenabled()
    gc.set_threshold(100, 1000, 1000)
    gc.callbacks.append(lambda phase, info: collections.append(phase))
    try:
        gc.enable()
        message = deserialize(data, path)
        assert len(collections) <= 2  # one, when the message was whole
        refused(deserialize, data[:-100], path)
        assert gc.isenabled()
        gc.disable()
        assert deserialize(data, path) == message
        assert not gc.isenabled()
    finally:
        gc.callbacks.pop()
        gc.set_threshold(*thresholds)
        if enabled:
            gc.enable()


def test_threads(classes: Classes) -> None:
    """First uses of the same classes, and then much work, in many threads at once."""
    fresh = [
        cls
        for cls in classes.values()
        if cls.__module__.startswith(("shape_msgs", "stereo_msgs", "nav_msgs"))
    ]
    ready, failures = threading.Barrier(8), []

    def work() -> None:
        try:
            ready.wait(10)
            for _ in range(30):
                for cls in fresh:
                    assert deserialize(serialize(cls()), cls) == cls()
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=work) for _ in range(8)]
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
    finally:
        sys.setswitchinterval(interval)
    assert not failures and not any(thread.is_alive() for thread in threads)


def test_attributes_of_a_class_that_are_gone_or_replaced(classes: Classes) -> None:
    """C goes by where the slots are, which no change of the class moves."""
    cls: Any = type("Some", (), {"__slots__": ("a", "b")})
    slot = cls.a
    NATIVE.codec_attach(cls, lambda _: b"python", lambda _: "python", "R2 d0.a d0.b", ())
    message = cls()
    message.a, message.b = 0.1, 0.2
    data = NATIVE.serialize(message)
    del cls.a
    assert NATIVE.serialize(message) == data
    assert slot.__get__(NATIVE.deserialize(data, cls)) == 0.1
    cls.a = 7
    assert NATIVE.serialize(message) == data
    del message.b
    assert NATIVE.serialize(message) == b"python"


def test_a_message_of_another_class(classes: Classes) -> None:
    """`__class__` may be assigned where the slots are alike, and the new class decides."""
    point, vector = classes["geometry_msgs/msg/Point"], classes["geometry_msgs/msg/Vector3"]
    message = point(x=0.1)
    serialize(message), serialize(vector())
    derived = type("Derived", (point,), {"__slots__": ()})
    message.__class__ = derived
    assert deserialize(serialize(message), point) == point(x=0.1)


def test_messages_in_each_other() -> None:
    """A table that calls a table that calls a table: C goes 200 deep, and leaves what is deeper to Python.

    Python cannot import classes that nest so deeply, so these are made by hand.
    """
    inner: Any = type("Level0", (), {"__slots__": ("inner",)})
    NATIVE.codec_attach(inner, lambda _: b"python", lambda _: "python", "R1 b0.inner", ())
    message, written = inner(), []
    message.inner = 7
    for level in range(1, 1000):
        cls: Any = type(f"Level{level}", (), {"__slots__": ("inner",)})
        NATIVE.codec_attach(cls, lambda _: b"python", lambda _: "python", "R1 E0.inner.1.0 C1.0", (inner,))
        outer = cls()
        outer.inner = message
        inner, message = cls, outer
        written.append(NATIVE.serialize(message))
        read = NATIVE.deserialize(b"\0\1\0\0\7", cls)
        assert (read == "python") == (written[-1] == b"python") == (level > 200)
    assert set(written) == {b"\0\1\0\0\7", b"python"}


def test_lists_in_each_other() -> None:
    """A loop in a loop, 199 times, in one table."""
    cls: Any = type("Level", (), {"__slots__": ("inner",)})
    text = " ".join(f"F{n}.inner.{n + 1}.0.0.0.{200 - n}" for n in range(199)) + " R1 b199.inner"
    NATIVE.codec_attach(cls, lambda _: b"python", lambda _: "python", text, (cls,))
    message = cls()
    message.inner = 7
    for _ in range(199):
        outer = cls()
        outer.inner, message = [message], outer
    message.inner *= 2
    data = NATIVE.serialize(message)
    assert NATIVE.serialize(NATIVE.deserialize(data, cls)) == data != b"python"
