"""Generated classes in processes of their own: what they load, and how they coexist with ROS's compiled classes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

CODEGEN = Path(__file__).resolve().parents[2] / "codegen"


def run(code: str, *path: Path, arguments: tuple[str, ...] = ()) -> str:
    """The output of a program that finds packages here before it searches elsewhere."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))}
    done = subprocess.run(
        [sys.executable, *arguments, "-c", code],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_importing_loads_little(generated: Path) -> None:
    import numpy

    code = """
import sys
before = set(sys.modules)
import class_msgs.msg, class_msgs.srv, class_msgs.action, geometry_msgs.msg
assert not [name for name in sys.modules if "._" in name and name.startswith("class_msgs")]
from class_msgs.msg import Status, Words, Defaults
from class_msgs.action import Walk
Status(), Walk.Goal()
heavy = {"numpy", "typing", "dataclasses", "inspect", "enum", "re", "copy", "ifgen"}
heavy |= {"functools", "importlib", "types", "warnings"}  # each takes as long as a message class or two
heavy &= sys.modules.keys() - before
assert not heavy, heavy
Defaults()
assert "numpy" in sys.modules
"""
    site_packages = Path(numpy.__file__).parents[1]
    run(
        code, generated, CODEGEN, site_packages, arguments=("-S",)
    )  # no .pth file may have loaded them before


def test_slot_types_need_no_ros(generated: Path) -> None:
    code = """
import sys
sys.modules["rosidl_parser"] = None
from class_msgs.msg import Defaults
types = Defaults.SLOT_TYPES
del sys.modules["rosidl_parser"]
sys.path.insert(0, "UNDERLAY")
from rosidl_parser import definition
assert types[0] == definition.BasicType("double") != definition.BasicType("float")
assert types[3] == definition.UnboundedSequence(definition.BasicType("float"))
assert types[5] == definition.NamespacedType(["builtin_interfaces", "msg"], "Time")
assert types[6] == definition.Array(definition.NamespacedType(["geometry_msgs", "msg"], "Point"), 2)
assert types[6].value_type.namespaced_name() == ("geometry_msgs", "msg", "Point")
"""
    run(code.replace("UNDERLAY", str(CODEGEN / "underlay")), generated, CODEGEN)


def test_messages_hold_compiled_messages(generated: Path) -> None:
    pytest.importorskip("rclpy", reason="the ROS wheels are not installed (Linux x86_64 only)")
    code = """
import copy, pickle, sys
sys.path.append("GENERATED")  # behind the wheels, as `ifgen run --transport rclpy` has it
import builtin_interfaces.msg
from builtin_interfaces.msg import Time
from class_msgs.msg import Defaults
from class_msgs.srv import Plan
assert not hasattr(Time, "__type_hash__"), "this is not the compiled class"

for checks in (False, True):
    message = Defaults(check_fields=checks)
    assert type(message.stamp) is Time
    assert repr(message.stamp) == "builtin_interfaces.msg.Time(sec=0, nanosec=0)"
    assert repr(message.stamp) in repr(message)
    message.stamp = Time(sec=3)
    for twin in (copy.copy(message), copy.deepcopy(message), pickle.loads(pickle.dumps(message))):
        assert twin == message != Defaults()
        assert twin.stamp.sec == 3
    assert copy.deepcopy(message).stamp is not message.stamp
    assert copy.deepcopy(message).corners[0] is not message.corners[0]
    assert [type(type_).__name__ for type_ in message.SLOT_TYPES][5] == "NamespacedType"

class Twin:
    "What another copy of builtin_interfaces would bring."
Twin.__name__, Twin.__module__ = "Time", Time.__module__
message = Defaults(check_fields=True)
message.stamp = Twin()
try:
    message.stamp = object()
except AssertionError as error:
    assert str(error) == "The 'stamp' field must be a sub message of type 'Time'"
else:
    raise SystemExit("an object of another class was accepted")
assert Plan.Event().info.stamp == Time()
"""
    run(code.replace("GENERATED", str(generated)), CODEGEN)


def test_the_types_have_the_interface_of_rosidl_parser() -> None:
    reference = pytest.importorskip("rosidl_parser.definition", reason="the ROS wheels are not installed")
    from ifgen_runtime import rosidl_types

    names = [name for name in vars(rosidl_types) if name[0].isupper() and hasattr(reference, name)]
    assert len(names) == 17

    def examples(module: object) -> list[object]:
        get = vars(module).__getitem__
        value_types = [get("BasicType")("int8"), get("BasicType")("double"), get("UnboundedString")()]
        value_types += [get("BoundedString")(3), get("BoundedString")(4), get("BoundedWString")(3)]
        value_types += [get("UnboundedWString")(), get("NamedType")("a")]
        value_types += [get("NamespacedType")(["p", "msg"], name) for name in ("A", "B")]
        nested = [get("Array")(type_, 3) for type_ in value_types]
        nested += [get("BoundedSequence")(type_, 3) for type_ in value_types]
        nested += [get("UnboundedSequence")(type_) for type_ in value_types]
        return [*value_types, *nested, get("Array")(value_types[0], 4)]

    def facts(types: list[object]) -> list[object]:
        equal = [[a == b for a in types] for b in types]
        bases = [[base.__name__ for base in type(type_).__mro__] for type_ in types]
        bounded = [type_.has_maximum_size() for type_ in types if hasattr(type_, "has_maximum_size")]
        return [equal, bases, bounded, [type_.__hash__ for type_ in types]]

    assert facts(examples(rosidl_types)) == facts(examples(reference))
