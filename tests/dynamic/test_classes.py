"""Classes made at run time are the classes that `ifgen generate` writes."""

from __future__ import annotations

import copy
import json
import pickle
import random
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import ifgen.dynamic
import pytest
from ifgen.definition.interfaces import Action, Message, Service
from ifgen.pipeline import stages
from ifgen_runtime import to_dict
from ifgen_runtime.codec import deserialize, serialize
from ifgen_runtime.field_types import fields_of
from ifgen_runtime.message import generated_class
from ifgen_runtime.type_description import describe, type_name

from tests.runtime.support import imported_from

ROOT = Path(__file__).resolve().parents[2]


GENERATED = ROOT / "generated"
FOLDERS = [path for path in (ROOT / "interfaces").iterdir() if path.is_dir()]
INTERFACES = {interface.type_name: interface for interface in stages.load(*FOLDERS)}
PACKAGES = sorted({interface.package for interface in INTERFACES.values()})


@pytest.fixture(scope="module", autouse=True)
def _generated() -> Iterator[None]:
    """The generated classes, not those of a ROS that may be installed."""
    with imported_from(GENERATED, (path.name for path in GENERATED.iterdir())):
        yield


def bundled(name: str) -> type[Any]:
    """The generated class of a bundled interface."""
    interface = INTERFACES[name]
    cls: type[Any] = getattr(import_module(f"{interface.package}.{interface.folder}"), interface.name)
    return cls


def parts(cls: type[Any]) -> list[type[Any]]:
    """The messages of an interface class."""
    if hasattr(cls, "Goal"):
        impl = cls.Impl
        services = (part for s in (impl.SendGoalService, impl.GetResultService) for part in parts(s))
        return [cls.Goal, cls.Result, cls.Feedback, impl.FeedbackMessage, *services]
    if hasattr(cls, "Request"):
        return [cls.Request, cls.Response, cls.Event]
    return [cls]


def fill(message: Any, rng: random.Random) -> Any:
    """A message with values in all its fields."""
    for field in fields_of(type(message)):
        attribute = field.slot.removeprefix("_")
        count = 1 if not field.is_collection else field.size or min(2, field.maximum or 2)
        values = [_value(field.type, rng) for _ in range(count)]
        setattr(message, attribute, values if field.is_collection else values[0])
    return message


def _value(type_: Any, rng: random.Random) -> Any:
    if isinstance(type_, type):
        return fill(type_(), rng)
    if not hasattr(type_, "format"):
        return "é0.1"[: type_.maximum]
    if type_.name == "boolean":
        return rng.random() < 0.5
    if type_.format == "c":
        return bytes([rng.randrange(128)]) if type_.name == "octet" else chr(rng.randrange(128))
    return rng.choice((0.5, -1.25)) if type_.is_float else rng.randint(*type_.range)


@pytest.mark.parametrize("package", PACKAGES)
def test_round_trip(package: str) -> None:
    for name, interface in INTERFACES.items():
        if interface.package == package:
            check_round_trip(name)


def check_round_trip(name: str) -> None:
    """Description of the generated class -> class -> the same hash and description, bytes and values."""
    generated = bundled(name)
    made = ifgen.dynamic.class_of(describe(generated), generated.__type_hash__)
    assert made is not generated
    assert made.__type_hash__ == generated.__type_hash__
    assert describe(made) == describe(generated)
    rng = random.Random(name)
    for one, other in zip(parts(generated), parts(made), strict=True):
        assert (other.__name__, other.__type_hash__) == (one.__name__, one.__type_hash__)
        assert type(other).__mro__[1] is type(one).__mro__[1], "the same metaclass below its own"
        assert to_dict(other()) == to_dict(one())
        for message in (one(), fill(one(), rng)):
            data = serialize(message)
            received = deserialize(data, other)
            assert generated_class(type(received)) is other
            assert to_dict(received) == to_dict(message)
            assert repr(received) == repr(message)
            assert serialize(received) == data
            assert deserialize(serialize(received), one) == message
            assert copy.deepcopy(received) == received


def test_the_classes_of_one_definition_are_one_class() -> None:
    pose = bundled("geometry_msgs/msg/PoseStamped")
    made = ifgen.dynamic.class_of(describe(pose))
    assert ifgen.dynamic.class_of(json.dumps(describe(pose))) is made
    assert ifgen.dynamic.class_of({"type_description_msg": describe(pose), "type_hashes": []}) is made
    header = ifgen.dynamic.class_of(describe(bundled("std_msgs/msg/Header")))
    assert type(made().header) is header
    text = (ROOT / "interfaces/geometry_msgs/msg/PoseStamped.msg").read_text()
    assert ifgen.dynamic.class_from_text("geometry_msgs/msg/PoseStamped", text) is made


def test_a_message_of_ros_is_a_description() -> None:
    from ifgen_runtime import from_dict

    cls = bundled("sensor_msgs/msg/JointState")
    message = from_dict(bundled("type_description_interfaces/msg/TypeDescription"), describe(cls))
    assert ifgen.dynamic.class_of(message) is ifgen.dynamic.class_of(describe(cls))


def test_two_versions_live_side_by_side() -> None:
    before = dict(sys.modules)
    name, point = "geometry_msgs/msg/Point", bundled("geometry_msgs/msg/Point")
    old = ifgen.dynamic.class_from_text(name, "float64 x\nfloat64 y\n")
    new = ifgen.dynamic.class_from_text(name, "float64 y 0.1\nfloat64 x 0.2\nuint8 K=1\n")
    assert len({old.__type_hash__, new.__type_hash__, point.__type_hash__}) == 3
    assert len({old.__module__, new.__module__, point.__module__}) == 3
    assert type_name(old) == type_name(new) == name
    assert repr(old(x=0.1)) == "geometry_msgs.msg.Point(x=0.1, y=0.0)"
    assert repr(new(x=0.3)) == "geometry_msgs.msg.Point(y=0.1, x=0.3)"
    assert old(x=0.1) != new(x=0.1)
    assert new.K == 1
    assert import_module("geometry_msgs.msg").Point is point
    assert {key: module for key, module in sys.modules.items() if key in before} == before
    assert not [key for key in sys.modules.keys() - before.keys() if key.startswith("geometry_msgs")]


def test_nested_versions_belong_to_their_own_outer_class() -> None:
    outer = "Point p\n"
    old, new = (
        ifgen.dynamic.class_from_text(
            "geometry_msgs/msg/Held", outer, others={"geometry_msgs/msg/Point": text}
        )
        for text in ("float64 x\n", "float32 x 0.5\n")
    )
    assert serialize(old()) != serialize(new())
    assert new().p.x == 0.5
    assert deserialize(serialize(new()), new) == new()


def test_a_default_makes_another_class() -> None:
    """Defaults are not in the hash, and still they are different classes."""
    one, other = (ifgen.dynamic.class_from_text("a_msgs/msg/A", f"float64 x {x}\n") for x in ("0.1", "0.2"))
    assert one.__type_hash__ == other.__type_hash__
    assert (one().x, other().x) == (0.1, 0.2)


def test_text_of_a_service_and_an_action() -> None:
    service = ifgen.dynamic.class_from_text("a_msgs/srv/Ask", "geometry_msgs/Point at\n---\nbool ok\n")
    assert service.Request().at.x == 0.0
    assert ifgen.dynamic.class_of(describe(service.Request)) is service.Request
    described = ifgen.dynamic.class_of(describe(service))  # another class: ServiceEventInfo has constants
    assert (described.__type_hash__, described.Request) == (service.__type_hash__, service.Request)
    action = ifgen.dynamic.class_from_text("a_msgs/action/Go", "int8 a\n---\nint8 b\n---\nint8 c\n")
    assert action.Impl.SendGoalService.Request().goal == action.Goal()
    assert ifgen.dynamic.class_of(describe(action)).Goal is action.Goal


def test_text_as_bags_have_it() -> None:
    rule = "=" * 80
    text = f"geometry_msgs/Point at\n{rule}\nMSG: geometry_msgs/Point\nfloat32 only\n{rule}\nMSG: a_msgs/Else\nint8 a\n"
    cls = ifgen.dynamic.class_from_text("a_msgs/msg/Bagged", text)
    assert cls().at.only == 0.0


def test_idl_text() -> None:
    text = "module a_msgs { module msg { struct Held { char Letter; unsigned long count; }; }; };"
    cls = ifgen.dynamic.class_from_text("a_msgs/msg/Held", text, idl=True)
    assert list(cls.get_fields_and_field_types()) == ["Letter", "count"]
    assert ifgen.dynamic.class_of(describe(cls)) is cls


def test_comments_and_constants_come_from_text() -> None:
    text = "# How fast.\nfloat64 x 0.1 # [m/s]\nuint8 FAST=3\nuint8 mode\n"
    cls = ifgen.dynamic.class_from_text("a_msgs/msg/Speed", text)
    assert cls.__doc__ == "How fast."
    assert cls.FAST == 3


@pytest.mark.parametrize("name", ["geometry_msgs/msg/PoseStamped", "std_srvs/srv/SetBool"])
def test_pickle(name: str) -> None:
    """Classes and messages survive pickle, in this process and in another one that has never seen the class."""
    made = ifgen.dynamic.class_of(describe(bundled(name)))
    message = parts(made)[0]()
    assert pickle.loads(pickle.dumps(made)) is made
    assert pickle.loads(pickle.dumps(message)) == message
    assert copy.copy(made) is made
    program = (
        "import pickle, sys; m = pickle.load(sys.stdin.buffer); print(type(m).__type_hash__, m, sep='\\n')"
    )
    ran = subprocess.run(
        [sys.executable, "-c", program],
        input=pickle.dumps(message),
        capture_output=True,
        check=True,
        timeout=60,
    )
    assert ran.stdout.decode().splitlines() == [type(message).__type_hash__, repr(message)]


def test_messages_with_checks() -> None:
    cls = ifgen.dynamic.class_from_text("a_msgs/msg/Checked", "geometry_msgs/Point at\nint8 a\n")
    message = cls(a=1, check_fields=True)
    with pytest.raises(AssertionError, match=r"int8|integer|signed"):
        message.a = 300
    assert pickle.loads(pickle.dumps(message)) == message


def test_a_large_message_calls_the_codec_of_a_large_one() -> None:
    many = "".join(f"float64 x{number} 0.1\nstring s{number}\n" for number in range(100))
    others = {"a_msgs/msg/Many": many}
    cls = ifgen.dynamic.class_from_text("a_msgs/msg/Larger", "Many[2] many\nMany one\n", others=others)
    data = serialize(cls())
    assert deserialize(data, cls) == cls()
    assert "__write__" in vars(type(cls().one))


def test_a_codec_is_made_when_it_is_used() -> None:
    cls = ifgen.dynamic.class_from_text(
        "a_msgs/msg/Later", "geometry_msgs/Vector3 at\nint8 unlike_any_other\n"
    )
    assert type(vars(cls)["__serialize__"]).__name__ == "_Later"
    function = cls.__serialize__
    assert type(vars(cls)["__serialize__"]).__name__ != "_Later"
    assert function(cls()) == serialize(cls())


def test_the_kinds_of_interfaces_are_all_among_the_bundled() -> None:
    assert {type(interface) for interface in INTERFACES.values()} == {Message, Service, Action}
