"""Copies and equality mean the same in C and in Python. The fuzzer (test_fuzzing.py) tries what no program would do."""

from __future__ import annotations

import copy
import pickle
import random
import re
import subprocess
import sys
from array import array
from collections.abc import Callable
from typing import Any

import numpy
import pytest
from ifgen_runtime.codec.choice import chosen

from .fuzzing.corpus import message as random_message
from .fuzzing.graphs import graph, identities
from .support import Classes

NATIVE: Any = chosen().extension
CODECS = [
    pytest.param(True, id="C", marks=pytest.mark.skipif(NATIVE is None, reason=chosen().reason)),
    pytest.param(False, id="Python"),
]


class Methods:
    """The methods of a class, in C or as they were generated."""

    def __init__(self, in_c: bool) -> None:
        self._in_c = in_c

    def _method(self, message: Any, name: str) -> Callable[..., Any]:
        cls = type(message)
        assert cls() == cls()  # the first use of the class
        method = getattr(cls, f"__{name}__" if self._in_c else f"__generated_{name}__")
        assert (type(method).__name__ == "method_descriptor") is self._in_c
        return method

    def equal(self, one: Any, other: Any) -> bool:
        return self._method(one, "eq")(one, other)  # type: ignore[no-any-return]

    def deepcopy(self, message: Any, memo: dict[int, Any] | None = None) -> Any:
        return self._method(message, "deepcopy")(message, {} if memo is None else memo)

    def copy(self, message: Any) -> Any:
        return self._method(message, "copy")(message)


@pytest.fixture(params=CODECS)
def methods(request: pytest.FixtureRequest) -> Methods:
    return Methods(request.param)


def test_every_class(classes: Classes, methods: Methods) -> None:
    for name, cls in classes.items():
        message = random_message(random.Random(name), cls)
        expected = graph(message)
        for made in (methods.deepcopy(message), methods.copy(message)):
            assert graph(made) == expected
        deep = methods.deepcopy(message)
        assert not identities(message) & identities(deep)
        has_nan = bool(re.search(r"\bnan\b", repr(message)))
        assert methods.equal(message, deep) is methods.equal(deep, message) is (not has_nan)
        assert methods.equal(cls(), cls()) is True


def test_what_is_there_twice_is_copied_once(classes: Classes, methods: Methods) -> None:
    pose = classes["geometry_msgs/msg/PoseStamped"]()
    path = classes["nav_msgs/msg/Path"](poses=[pose, pose], header=pose.header)
    made = methods.deepcopy(path)
    assert made.poses[0] is made.poses[1] is not pose
    assert made.header is made.poses[0].header is not pose.header
    names = ["a"]
    joints = classes["sensor_msgs/msg/JointState"](name=names)
    first, second = copy.deepcopy([joints, joints])
    assert first is second is not joints
    assert methods.deepcopy(joints).name == names
    assert methods.deepcopy(joints).name is not joints.name


def test_a_memo_is_honoured(classes: Classes, methods: Methods) -> None:
    pose = classes["geometry_msgs/msg/PoseStamped"]()
    other = classes["std_msgs/msg/Header"](frame_id="map")
    assert methods.deepcopy(pose, {id(pose.header): other}).header is other
    assert methods.deepcopy(pose, {id(pose): pose}) is pose


def test_floats_compare_as_floats(classes: Classes, methods: Methods) -> None:
    point, joints = classes["geometry_msgs/msg/Point"], classes["sensor_msgs/msg/JointState"]
    camera = classes["sensor_msgs/msg/CameraInfo"]
    nan = float("nan")
    assert methods.equal(point(x=0.0), point(x=-0.0))
    assert not methods.equal(one := point(x=nan), one)
    assert methods.equal(joints(position=[0.0, 0.1]), joints(position=[-0.0, 0.1]))
    assert not methods.equal(one := joints(position=[nan]), one)
    assert not methods.equal(joints(position=[0.1]), joints(position=[0.1, 0.2]))
    assert methods.equal(camera(), camera())
    assert not methods.equal(camera(k=[nan] * 9), camera(k=[nan] * 9))
    same = point(x=nan)
    poses = classes["geometry_msgs/msg/Polygon"]
    assert methods.equal(poses(points=[same]), poses(points=[same])), (
        "a list takes an object for equal to itself"
    )


def test_other_values_in_fields(classes: Classes, methods: Methods) -> None:
    """A numpy array in a sequence, a tuple, an int in a float field: what programs do with checks off."""
    joints, image = classes["sensor_msgs/msg/JointState"](), classes["sensor_msgs/msg/Image"]()
    joints._position = numpy.array([0.1, 0.2])
    joints._name = ("a", "b")
    made = methods.deepcopy(joints)
    assert type(made._position) is numpy.ndarray and not numpy.shares_memory(made._position, joints._position)
    assert made._name == ("a", "b")
    same = classes["sensor_msgs/msg/JointState"](position=[0.1, 0.2])
    same._name = ("a", "b")
    assert methods.equal(joints, same) and methods.equal(same, joints)
    view = numpy.frombuffer(b"\1\2", numpy.uint8)
    image._data = view
    assert methods.deepcopy(image)._data.flags.writeable
    other = classes["sensor_msgs/msg/Image"](data=array("B", [1, 2]))
    assert methods.equal(image, other) and methods.equal(other, image)
    point = classes["geometry_msgs/msg/Point"]()
    point.x = 1
    assert methods.equal(point, classes["geometry_msgs/msg/Point"](x=1.0))
    assert type(methods.deepcopy(point).x) is int


def test_fields_without_a_value(classes: Classes, methods: Methods) -> None:
    point = classes["geometry_msgs/msg/Point"]()
    del point.y
    with pytest.raises(AttributeError, match="y"):
        methods.deepcopy(point)
    with pytest.raises(AttributeError, match="y"):
        methods.equal(point, classes["geometry_msgs/msg/Point"]())
    assert not hasattr(methods.copy(point), "y")


def test_checks_and_derived_classes(classes: Classes) -> None:
    """Their objects are copied with what they are, also inside a message, and equal only to their like."""
    point, pose = classes["geometry_msgs/msg/Point"], classes["geometry_msgs/msg/Pose"]

    class Labelled(point):  # type: ignore[misc, valid-type]  # a class at run time
        label = ""

    class Careful(Labelled):
        def __deepcopy__(self, memo: dict[int, Any]) -> str:
            return "careful"

    class More(Careful):
        pass

    checked, labelled = point(x=0.1, check_fields=True), Labelled(x=0.1)
    labelled.label = "goal"
    for copied in (copy.copy, copy.deepcopy):
        with pytest.raises(AssertionError):
            copied(checked).x = "far"
        assert (copied(labelled).label, copied(labelled).x, type(copied(labelled))) == ("goal", 0.1, Labelled)
        holder = copied(pose(position=labelled))
        assert type(holder.position) is Labelled and holder.position.label == "goal"
    assert copy.deepcopy(More()) == "careful", "inherited from what its author wrote"
    assert checked == point(x=0.1) and point(x=0.1) == checked
    assert labelled != point(x=0.1) and point(x=0.1) != labelled
    assert labelled == Labelled(x=0.1)
    assert pose(position=checked) == pose(position=point(x=0.1))


def test_a_message_inside_itself(classes: Classes, methods: Methods) -> None:
    joints = classes["sensor_msgs/msg/JointState"]()
    joints._name = [joints]
    made = methods.deepcopy(joints)
    assert made._name[0] is made
    with pytest.raises(RecursionError):
        methods.equal(joints, made)


def test_pickles_are_the_same(classes: Classes) -> None:
    message = classes["geometry_msgs/msg/Pose"]()
    copy.deepcopy(message)
    parts = message.__reduce_ex__(4)
    assert parts[1] == (type(message),) and parts[2][0] is None
    assert set(parts[2][1]) == {"_position", "_orientation", "_check_fields"}
    assert pickle.dumps(message.position.x)


FIRST_USE = """
import copy
from geometry_msgs.msg import Point, Pose
for first in (lambda m: m == m, lambda m: m != m, copy.copy, copy.deepcopy, lambda m: [m].index(type(m)())):
    first(Pose())
    first(Point())
print(type(Pose.__eq__).__name__, type(Pose.__deepcopy__).__name__, type(Pose.__copy__).__name__)
"""


@pytest.mark.parametrize(
    ("codec", "kind"),
    [pytest.param("native", "method_descriptor", marks=CODECS[0].marks), ("python", "function")],
)
def test_the_first_use_of_a_class(codec: str, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IFGEN_CODEC", codec)
    monkeypatch.setenv("PYTHONPATH", "generated")
    said = subprocess.run(
        [sys.executable, "-c", FIRST_USE], capture_output=True, text=True, timeout=60, check=True
    )
    assert said.stdout.split() == [kind] * 3
