"""The behaviour of the classes of some packages, as text: it must be the same for ours and rosidl's.

A value that a field may take as an array is labelled: ours takes arrays that Python and numpy refuse to rosidl's
setters. tests/codec/test_array_fields.py has those.

It is a program, for a process with only one set of classes: `class_transcript.py PACKAGE...` prints a JSON
object, class name to lines. With `--thorough` it assigns every kind of value to fields of every type.
"""

from __future__ import annotations

import collections
import copy
import importlib
import inspect
import json
import pickle
import sys
from array import array
from typing import Any

import numpy

FOLDERS = ("msg", "srv", "action")
SCALARS: list[Any] = [
    None,
    True,
    False,
    *(
        0,
        1,
        -1,
        3,
        -128,
        -129,
        127,
        128,
        255,
        256,
        65535,
        65536,
        -(2**31),
        2**31,
        2**32,
        2**63,
        -(2**63) - 1,
        2**64,
    ),
    *(0.0, -0.0, 1.5, 0.1, 3.5e38, 1e300, float("inf"), float("-inf"), float("nan")),
    *("", "a", "12345", "123456", "é\0"),
    *(b"", b"a", b"ab", bytearray(b"a"), bytearray(b"ab")),
    collections.UserString("12345"),
    collections.UserString("123456"),
    numpy.float64(1.5),
    numpy.float32(1.5),
    numpy.int32(3),
    numpy.bool_(True),
    object,
]
ELEMENTS: list[Any] = [True, 3, -1, 300, 2**70, 0.5, 1e300, float("nan"), "a", "123456", b"a", b"ab", None]


def collection_values() -> list[Any]:
    """Values to assign to a list, an array or a sequence field; new ones each time."""
    values: list[Any] = [
        [],
        (),
        {1},
        frozenset({2, 3}),
        {"a": 1},
        range(3),
        iter([1, 2, 3]),
        memoryview(b"abc"),
    ]
    values += [[element] * count for element in ELEMENTS for count in (1, 3, 4, 5)]
    values += [tuple([element] * 3) for element in ELEMENTS]
    values += [
        collections.UserList([1, 2, 3]),
        collections.deque([1, 2, 3]),
        [1, 2.0, 3],
        [1, "a", None],
        [[1], [2]],
    ]
    values += [array(code, [1] * count) for code in "bBhHiIqQfd" for count in (3, 5)]
    values += [numpy.ones(count, dtype) for dtype in ("f4", "f8", "u1", "i4", "i8", "?") for count in (3, 4)]
    values += [numpy.zeros((3, 1)), numpy.zeros((1, 3)), numpy.array(["a", "b", "c"])]
    values += [numpy.array([1, 2, 3], dtype) for dtype in (">f4", ">f8", "f2")]
    values += [numpy.arange(6, dtype=dtype)[::2] for dtype in ("u1", ">u2", "i8", "f4", "f8")]
    values += [numpy.ones((3, 2, 2), "u1"), numpy.ones(3, object), numpy.empty(0)]
    values += [bytearray(b"abc"), memoryview(b"abcdef")[::2], memoryview(array("d", [1, 2, 3]))]
    return values


ARRAYS = (numpy.ndarray, array, memoryview, bytes, bytearray, str)


def text(value: Any) -> str:
    """A value with its type; object addresses and error texts of Python itself are the same in both processes."""
    shown = repr(value) if not inspect.isgenerator(value) else "generator"
    shown = shown.split(" at 0x")[0]
    return f"{type(value).__module__}.{type(value).__qualname__} {shown[:2000]}"


def outcome(action: Any) -> str:
    """The result or the error of an action."""
    try:
        return text(action())
    except Exception as error:
        kind = AssertionError if isinstance(error, AssertionError) else type(error)
        return f"! {kind.__name__}: {error}"


class Transcript:
    """The lines of one class."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, label: str, action: Any) -> None:
        """Add what an action does."""
        self.lines.append(f"{label} -> {outcome(action)}")

    def equal(self, label: str, value: Any) -> None:
        """Add a value that has no type to show."""
        self.lines.append(f"{label} = {value}")


def main() -> None:
    """Print the transcript of the packages in the arguments."""
    thorough = "--thorough" in sys.argv
    seen: set[str] = set()
    transcripts: dict[str, list[str]] = {}
    for package in (argument for argument in sys.argv[1:] if argument != "--thorough"):
        for folder in FOLDERS:
            try:
                module = importlib.import_module(f"{package}.{folder}")
            except ModuleNotFoundError:
                continue
            names = sorted(name for name in dir(module) if not name.startswith("_"))
            transcripts[f"{package}.{folder}"] = names
            for name in names:
                transcripts[f"{package}.{folder}.{name}"] = class_lines(getattr(module, name), seen, thorough)
                for part in ("Goal", "Result", "Feedback"):
                    if cls := getattr(getattr(module, name), part, None):
                        transcripts[f"{package}.{folder}.{name}.{part}"] = class_lines(cls, seen, thorough)
    json.dump(transcripts, sys.stdout, indent=0)


def class_lines(cls: Any, seen: set[str], thorough: bool) -> list[str]:
    """Everything about one class; fields of a type that was tried before are tried less."""
    t = Transcript()
    about_class(cls, t)
    if hasattr(cls, "SLOT_TYPES"):
        about_message(cls, t)
        about_constants(cls, t)
        about_operators(cls, t)
        for name, type_text in cls.get_fields_and_field_types().items():
            kind = f"{type_text} {hasattr(cls, name.upper() + '__DEFAULT')}"
            about_field(cls, name, t, thorough=thorough and kind not in seen)
            seen.add(kind)
    else:
        about_parts(cls, t)
    return t.lines


def about_class(cls: Any, t: Transcript) -> None:
    """Names, module, metaclass."""
    meta = type(cls)
    module = sys.modules[cls.__module__]
    t.equal("name", (cls.__name__, cls.__qualname__, cls.__module__, meta.__name__, meta.__module__))
    t.equal(
        "metaclass in module", getattr(module, meta.__name__) is meta and getattr(module, cls.__name__) is cls
    )
    attributes = (
        "_CREATE_ROS_MESSAGE",
        "_CONVERT_FROM_PY",
        "_CONVERT_TO_PY",
        "_DESTROY_ROS_MESSAGE",
        "_TYPE_SUPPORT",
    )
    t.equal("type support", [(name, getattr(meta, name, "missing")) for name in attributes])
    t.equal("importable", callable(meta.__import_type_support__))
    t.add("positional", lambda: cls(1))
    cls.added_by_user = 5
    t.equal("set class attribute", cls.added_by_user)
    del cls.added_by_user


def about_parts(cls: Any, t: Transcript) -> None:
    """The classes that a service or action holds."""
    t.add("instantiate", cls)
    for name in ("Request", "Response", "Event", "Goal", "Result", "Feedback"):
        t.equal(name, getattr(cls, name, None))
    if impl := getattr(cls, "Impl", None):
        t.equal("Impl", (impl.__name__, impl.__qualname__))
        for name in (
            "SendGoalService",
            "GetResultService",
            "FeedbackMessage",
            "CancelGoalService",
            "GoalStatusMessage",
        ):
            t.equal(name, getattr(impl, name))


def slot_type(type_: Any) -> str:
    """A SLOT_TYPES object as text."""
    values = [
        getattr(type_, name)
        for name in ("typename", "namespaces", "name", "size", "maximum_size")
        if hasattr(type_, name)
    ]
    inner = [slot_type(type_.value_type)] if hasattr(type_, "value_type") else []
    return f"{type(type_).__module__}.{type(type_).__name__}({values}{inner})"


def about_message(cls: Any, t: Transcript) -> None:
    """The attributes of a message class, and its default object."""
    t.equal("slots", cls.__slots__)
    t.equal("fields", cls.get_fields_and_field_types())
    t.equal("fields are a copy", cls.get_fields_and_field_types() is not cls._fields_and_field_types)
    t.equal("fields kept", cls._fields_and_field_types == cls.get_fields_and_field_types())
    t.equal("slot types", [slot_type(type_) for type_ in cls.SLOT_TYPES])
    t.equal("slot types kept", cls.SLOT_TYPES is cls.SLOT_TYPES and cls().SLOT_TYPES is cls.SLOT_TYPES)
    for checks in (False, True):
        message = cls(check_fields=checks)
        t.equal(
            f"checks {checks}", (message._check_fields, message.__class__ is cls, isinstance(message, cls))
        )
        t.add("repr", lambda message=message: message)
        t.add("no such attribute", lambda message=message: message.no_such_attribute)
        t.add("set no such attribute", lambda message=message: setattr(message, "no_such_attribute", 1))
        t.add("hash", lambda message=message: hash(message))
        t.add("dict", lambda message=message: message.__dict__)
        t.equal("slots of object", message.__slots__)
        for name in cls.get_fields_and_field_types():
            t.add(f"default {name}", lambda message=message, name=name: getattr(message, name))
            t.equal("private is public", getattr(message, f"_{name}") is getattr(message, name))
    t.add("unknown keyword", lambda: cls(no_such_field=1, another=2, check_fields=True))
    t.equal("dir", [name for name in rosidl_names(cls) if not hasattr(cls, name)])


def rosidl_names(cls: Any) -> list[str]:
    """The names that rosidl's class has for this message; none may be missing."""
    names = [
        "SLOT_TYPES",
        "_check_fields",
        "_fields_and_field_types",
        "get_fields_and_field_types",
        "__eq__",
        "__repr__",
    ]
    fields = cls.get_fields_and_field_types()
    return [*names, *fields, *(f"_{name}" for name in fields)]


def about_constants(cls: Any, t: Transcript) -> None:
    """Constants and FIELD__DEFAULT, through the class and through objects."""
    message = cls()
    for name in sorted(name for name in dir(cls) if isinstance(vars(type(cls)).get(name), property)):
        t.add(f"{name}", lambda name=name: getattr(cls, name))
        t.add(f"object {name}", lambda name=name: getattr(message, name))
        t.add(f"set {name}", lambda name=name: setattr(cls, name, 1))
        t.add(f"delete {name}", lambda name=name: delattr(cls, name))
        t.add(f"object set {name}", lambda name=name: setattr(message, name, 1))
        t.equal("fresh", getattr(cls, name) is getattr(cls, name))
        t.equal("shared", getattr(message, name) is getattr(message, name))
        t.equal("in metaclass", isinstance(vars(type(cls))[name], property))


def about_operators(cls: Any, t: Transcript) -> None:
    """Equality, copies, pickles, subclasses."""

    class Derived(cls):
        pass

    for checks in (False, True):
        one, two, derived = cls(check_fields=checks), cls(), Derived(check_fields=checks)
        t.add("equal", lambda one=one, two=two: (one == two, two == one, one == 1, one != two, one == None))  # noqa: E711
        t.add("derived", lambda one=one, derived=derived: (one == derived, derived == one))
        t.add("derived repr", lambda derived=derived: derived)
        t.equal("derived dict", vars(derived))
        derived.extra = [1]
        for label, function in (
            ("copy", copy.copy),
            ("deepcopy", copy.deepcopy),
            *(
                (f"pickle {n}", lambda m, n=n: pickle.loads(pickle.dumps(m, n))) for n in range(2, 6)
            ),  # rosidl's classes refuse the older protocols
        ):
            try:
                copied = function(one)
            except TypeError as error:
                t.equal(label, error)
                continue
            t.equal(
                label,
                (copied == one, copied is one, copied._check_fields, copied.__class__, len(repr(copied))),
            )
            for name in cls.get_fields_and_field_types():
                value, original = getattr(copied, name), getattr(one, name)
                if not isinstance(value, (bool, int, float, str, bytes)):  # Python may share those anyway
                    t.equal(f"{label} shares {name}", value is original)
            if "pickle" not in label:
                copied = function(derived)
                t.equal("extra", (copied.extra, copied.extra is derived.extra, copied.__class__ is Derived))
        shared: list[Any] = [0.5]
        for name in cls.get_fields_and_field_types():
            setattr(two, f"_{name}", shared)
        copied = copy.deepcopy(two)
        values = [getattr(copied, f"_{name}") for name in cls.get_fields_and_field_types()]
        t.equal("deepcopy keeps sharing", [value is values[0] and value is not shared for value in values])
        copied = copy.deepcopy([one, one])
        t.equal("deepcopy keeps identity", copied[0] is copied[1])
        state = cls().__reduce_ex__(4)
        t.equal("reduce", (state[0].__name__, state[1], state[2]))
        switched = cls()
        switched._check_fields = checks
        t.equal("switched", (switched._check_fields, switched == one, switched.__class__ is cls))


def values_for(cls: Any, name: str, type_text: str) -> list[Any]:
    """Values to try in a field."""
    own = [cls(), getattr(cls(), name)]
    if "[" in type_text or "sequence<" in type_text:
        element = getattr(cls(), name)
        own += [[element[0]] * 3, [element[0], None, element[0]]] if len(element) and "[" in type_text else []
        return [*collection_values(), *SCALARS[:6], "abc", b"abc", *own]
    return [*SCALARS, *collection_values()[:12], *own]


def about_field(cls: Any, name: str, t: Transcript, *, thorough: bool) -> None:
    """Set a field to all kinds of values, in the constructor and by assignment, with and without checks."""
    type_text = cls.get_fields_and_field_types()[name]
    count = len(values_for(cls, name, type_text)) if thorough else 3
    for checks in (False, True):
        for index, value in enumerate(values_for(cls, name, type_text)[:count]):
            about = f"{index} of {'an array' if isinstance(value, ARRAYS) else 'a value'}"

            def construct(index: int = index, checks: bool = checks) -> Any:
                value = values_for(cls, name, type_text)[index]
                message = cls(**{name: value, "check_fields": checks})
                stored = getattr(message, name)
                return stored, stored is value

            def assign(index: int = index, checks: bool = checks) -> Any:
                value = values_for(cls, name, type_text)[index]
                message = cls(check_fields=checks)
                setattr(message, name, value)
                stored = getattr(message, name)
                return stored, stored is value, getattr(message, f"_{name}") is stored

            t.add(f"{name} {checks} construct {about}", construct)
            t.add(f"{name} {checks} assign {about}", assign)

            def compare(index: int = index) -> Any:
                value = values_for(cls, name, type_text)[index]
                message = cls(**{name: value})
                default, stored = getattr(cls(), f"_{name}"), getattr(message, f"_{name}")
                if isinstance(default, numpy.ndarray) and default.shape != stored.shape:
                    return "rosidl cannot compare arrays of another shape"
                same = cls(**{name: copy.copy(value)})
                return (
                    message == same,
                    message == cls(),
                    repr(message)[:3000],
                    copy.deepcopy(message) == message,
                )

            if not checks:
                t.add(f"{name} compare {about}", compare)
    t.add(f"delete {name} with checks", lambda: delattr(cls(check_fields=True), name))


if __name__ == "__main__":
    main()
