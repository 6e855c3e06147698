"""Tables for the codec in C: how programs are rendered, and that a malformed one is refused."""

from __future__ import annotations

import random
from pathlib import Path
from types import MemberDescriptorType
from typing import Any

import ifgen
import pytest
from ifgen.generator_py.codec.table import table_of
from ifgen.generator_py.names import slot_name
from ifgen.wire.plan import Extents, plan
from ifgen_runtime.codec.choice import chosen

from .support import Classes

NATIVE: Any = chosen().extension
needs_native = pytest.mark.skipif(NATIVE is None, reason=f"the codec in C does not run: {chosen().reason}")


def rows(folder: Path, text: str) -> tuple[list[str], list[str]]:
    """The rows of the table of a message with these fields, and the names of its classes."""
    messages = folder / "some_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Empty.msg").write_text("")
    (messages / "Point.msg").write_text("float64 x\nfloat64 y\n")
    (messages / "Large.msg").write_text("".join(f"string text{n}\n" for n in range(130)))
    (messages / "Some.msg").write_text(text)
    registry = ifgen.load(folder / "some_msgs")
    table = table_of(plan(registry.message("some_msgs/msg/Some"), Extents(registry), slot_name))
    return list(table.rows), [type_.name for type_ in table.types]


@pytest.mark.parametrize(
    ("text", "expected", "classes"),
    [
        ("", "R1 Z", []),
        ("bool a\nbyte b\nchar c\nint8 d\nfloat32 e", "R5 ?0._a o0._b B0._c b0._d f0._e", []),
        ("float64[9] a\nuint8[3] b\nbool[2] c", "R2 Ad0._a.9 AB0._b.3 S?0._c.2.0", []),
        ("string a\nstring<=5 b\nwstring c", "T0._a.0 T0._b.5 W0._c.0", []),
        ("uint8[] a\nuint8[<=5] b\nbyte[] c", "SB0._a.0.0 SB0._b.0.5 So0._c.0.0", []),
        ("string[] a\nstring<=4[<=5] b\nwstring[2] c", "L0._a.0.0.0 L0._b.4.0.5 K0._c.0.2.0", []),
        ("Point a\nint32 b", "R4 E0._a.1.0 d1._x d1._y i0._b", ["Point"]),
        (
            "Point[] a\nPoint[2] b\nEmpty c",
            "F0._a.1.0.0.0.3 R2 d1._x d1._y F0._b.2.0.2.0.3 R2 d2._x d2._y R2 E0._c.3.1 Z",
            ["Point", "Empty"],
        ),
        ("Large a\nLarge[<=3] b", "R1 E0._a.1.0 C1.0 F0._b.2.0.0.3.1 C2.0", ["Large"]),
    ],
)
def test_rows(tmp_path: Path, text: str, expected: str, classes: list[str]) -> None:
    found, types = rows(tmp_path, text)
    assert (" ".join(found), types) == (expected, classes)


def make_class(*slots: str) -> type[Any]:
    return type("Some", (), {"__slots__": slots})


def attach(text: str, *classes: type[Any], cls: type[Any] | None = None) -> Any:
    """Attach a table to a new class with the slots a to d."""
    return NATIVE.codec_attach(cls or make_class("a", "b", "c", "d"), repr, repr, text, classes)


INNER = make_class("x", "y")

SOUND = [
    ("R2 d0.a i0.b", ()),
    ("R3 E0.a.1.0 d1.x d1.y", (INNER,)),
    ("F0.a.1.0.0.3.2 R1 d1.x T0.b.0", (INNER,)),
    ("F0.a.1.0.0.0.5 F1.x.2.0.2.0.1 T2.x.0 R1 d1.y Sd0.b.0.7 L0.c.1.2.0", (INNER,)),
]

MALFORMED = [
    *(
        "",
        " ",
        "R",
        "R0",
        "R1",
        "R2 d0.a",
        "R1  d0.a",
        "R1 d0.a ",
        " R1 d0.a",
        "R1 d0.a i0.b",
        "X0.a",
        "R1 X0.a",
    ),
    *(
        "R1 d",
        "R1 d0",
        "R1 d0.",
        "R1 d1.a",
        "R1 d0.a.1",
        "R1 d-1.a",
        "R1 d99999999999999999999.a",
        "R1 d 0.a",
    ),
    *(
        "d0.a",
        "Z",
        "E0.a.1.0",
        "Ad0.a.9",
        "R1 R1",
        "R1 T0.a.0",
        "R1 Ad0.a.0",
        "R1 A?0.a.2",
        "R1 Ad0.a.4294967296",
    ),
    *("R1 Ad0.a.999999999", "R1 E0.a.0.0", "R1 E0.a.2.0", "R1 E0.a.1.1", "R1 E0.a.1", "R1 E0.a.1.0.0"),
    *("T0.a", "T0.a.x", "T0.a.4294967296", "Sd0.a", "Sd0.a.1.1", "Sx0.a.0.0", "L0.a.0.0", "K0.a.0.1.1"),
    *(
        "F0.a.1.0.0.0.0",
        "F0.a.1.0.0.0.1",
        "F0.a.1.0.0.0.2 R1 d0.a T0.b.0 T1.x.0",
        "F0.a.1.0.0.0.2 R2 d1.x d1.y",
    ),
    *("F0.a.1.0.0.0.1 E1.x.2.0", "F0.a.1.0.0.0.2 R1 E1.x.2.0", "F0.a.1.0.0.0.1 T1.x.0 T1.y.0"),
    *("C0.0", "C1.0", "R1 E0.a.1.0 C1.1", "R2 E0.a.1.0 d1.x C1.0", "R1 E0.a.1.0 C1.0 C1.0"),
    *("R1 E0.a.1.0 C1.0 T1.x.0", "\0", "R1 \0", "é", "R1 ?", "R1 \U0001f600"),
    " ".join(f"F{n}.a.{n + 1}.0.0.0.{300 - n}" for n in range(300)) + " T300.x.0",
]


@needs_native
@pytest.mark.parametrize(("text", "classes"), SOUND)
def test_a_sound_table_is_accepted(text: str, classes: tuple[type[Any], ...]) -> None:
    method, function = attach(text, *classes)
    assert (method.__name__, function.__name__) == ("__serialize__", "__deserialize__")


@needs_native
@pytest.mark.parametrize("text", MALFORMED)
def test_a_malformed_table_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="malformed at character"):
        attach(text, INNER)


@needs_native
@pytest.mark.parametrize(
    ("text", "classes", "words"),
    [
        ("R2 d0.a d0.a", (), "fills a slot twice"),
        ("R1 E0.a.1.0 C1.0", (INNER,), "has no codec in C"),
        ("R1 d0.nothing", (), "nothing"),
        ("R1 d0.a\0", (), "no attribute"),
        ("R1 d0.é", (), "no attribute"),
        ("R1 d0.__doc__", (), "is not a slot"),
        ("R1 d0.__class__", (), "is not a slot"),
        ("R2 E0.a.1.0 d1.x", (int,), "is not a message class"),
        ("R2 E0.a.1.0 d1.x", ("x",), "are not all classes"),
        ("R2 E0.a.1.0 d1.x", (type("Long", (tuple,), {}),), "is not a message class"),
    ],
)
def test_a_table_that_does_not_fit_the_classes_is_refused(text: str, classes: Any, words: str) -> None:
    with pytest.raises((AttributeError, TypeError, ValueError), match=words):
        attach(text, *classes)


@needs_native
def test_a_property_in_place_of_a_slot_is_not_called() -> None:
    def fail(self: Any, value: Any) -> None:
        raise AssertionError("code of a user ran")

    cls = make_class("a")
    cls.a = property(fail, fail)
    with pytest.raises(TypeError, match="is not a slot"):
        attach("R1 d0.a", cls=cls)


@needs_native
def test_one_slot_under_two_names_is_noticed() -> None:
    cls = make_class("a")
    assert isinstance(cls.a, MemberDescriptorType)
    cls._a = cls.a
    with pytest.raises(ValueError, match="fills a slot twice"):
        attach("R2 d0.a d0._a", cls=cls)


@needs_native
def test_mutated_tables_never_crash(classes: Classes) -> None:
    """What is accepted, runs: a message with empty slots is left to Python, zeros are read or left."""
    chance = random.Random(7)
    tables = [vars(cls)["__codec__"][2] for cls in classes.values()]
    accepted = 0
    for _ in range(5_000):
        text, *types = chance.choice(tables)
        for _ in range(chance.randrange(1, 4)):
            at, size = chance.randrange(len(text)), chance.randrange(3)
            text = (
                text[:at] + "".join(chance.choices("0123456789. RETFSLdiBCZA_x", k=size)) + text[at + size :]
            )
            text = text or "R1 Z"
        names = {word.split(".")[1] for word in text.split(" ") if word.count(".")}
        cls = type("Some", (), {"__slots__": [name for name in names if name.isidentifier()]})
        try:
            _, read = NATIVE.codec_attach(cls, lambda _: b"", lambda _: None, text, tuple(types))
        except (AttributeError, TypeError, ValueError):
            continue
        accepted += 1
        NATIVE.serialize(cls())
        read(b"\0\1\0\0" + bytes(chance.randrange(200)))
        read(b"\0\1\0\0" + chance.randbytes(100))
    assert accepted > 200
