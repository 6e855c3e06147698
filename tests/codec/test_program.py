"""The program of a message, and the knowledge that follows from it."""

from __future__ import annotations

from pathlib import Path

import ifgen
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.names import slot_name
from ifgen.wire.plan import Extents, plan
from ifgen.wire.positions import (
    Alignment,
    Positions,
    Tile,
    entry_alignment,
    following_alignments,
    largest_alignment,
    smallest_size,
    tile_of,
)
from ifgen.wire.program import (
    Array,
    Blank,
    Call,
    Count,
    Enter,
    Instruction,
    Program,
    Repeat,
    Run,
    Slot,
    Text,
    Texts,
    Value,
    Values,
)

POINT = NamespacedType("geometry_msgs", "msg", "Point")
QUATERNION = NamespacedType("geometry_msgs", "msg", "Quaternion")
EMPTY = NamespacedType("some_msgs", "msg", "Empty")
NAMED = NamespacedType("some_msgs", "msg", "Named")


def program(folder: Path, text: str) -> Program:
    """The program of a message with these fields."""
    messages = folder / "some_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Empty.msg").write_text("")
    (messages / "Named.msg").write_text("float64 x\nstring name\n")
    (messages / "Large.msg").write_text("".join(f"string text{n}\n" for n in range(130)))
    (messages / "Some.msg").write_text(text)
    registry = ifgen.load(folder / "some_msgs")
    return plan(registry.message("some_msgs/msg/Some"), Extents(registry), slot_name)


def instructions(folder: Path, text: str) -> tuple[Instruction, ...]:
    (group,) = program(folder, text).groups
    return group


def own(name: str) -> Slot:
    """A slot of the message itself."""
    return Slot(0, f"_{name}")


def coordinates(message: int, names: str) -> tuple[Value, ...]:
    return tuple(Value(Slot(message, f"_{name}"), "double") for name in names)


def test_nested_messages_of_fixed_layout_are_one_run(tmp_path: Path) -> None:
    assert instructions(tmp_path, "geometry_msgs/Pose pose\nfloat32[9] covariance\nEmpty end\n") == (
        Run(
            (
                Enter(own("pose"), 1, NamespacedType("geometry_msgs", "msg", "Pose")),
                Enter(Slot(1, "_position"), 2, POINT),
                *coordinates(2, "xyz"),
                Enter(Slot(1, "_orientation"), 3, QUATERNION),
                *coordinates(3, "xyzw"),
                Array(own("covariance"), "float", 9),
                Enter(own("end"), 4, EMPTY),
                Blank(),
            )
        ),
    )


def test_what_has_a_size_of_its_own_ends_a_run(tmp_path: Path) -> None:
    fields = "int8 a\nstring<=5 b\nwstring c\nbool d\nuint16[<=3] e\nbool[2] f\nstring[] g\n"
    assert instructions(tmp_path, fields) == (
        Run((Value(own("a"), "int8"),)),
        Text(own("b"), 5, wide=False),
        Text(own("c"), None, wide=True),
        Run((Value(own("d"), "boolean"),)),
        Values(own("e"), "uint16", Count(maximum=3)),
        Values(own("f"), "boolean", Count(size=2)),
        Texts(own("g"), None, wide=False, count=Count()),
    )


def test_elements_have_instructions_of_their_own(tmp_path: Path) -> None:
    planned = program(tmp_path, "geometry_msgs/Point[] points\nNamed[2] pair\n")
    assert planned.groups == (
        (
            Repeat(own("points"), 1, POINT, Count(), (Run(coordinates(1, "xyz")),)),
            Repeat(
                own("pair"),
                2,
                NAMED,
                Count(size=2),
                (Run(coordinates(2, "x")), Text(Slot(2, "_name"), None, wide=False)),
            ),
        ),
    )
    assert [holder.type for holder in planned.nested] == [POINT, NAMED]


def test_large_messages_are_called_and_have_groups(tmp_path: Path) -> None:
    large = NamespacedType("some_msgs", "msg", "Large")
    called = program(tmp_path / "called", "Large one\nLarge[] more\n")
    assert called.groups == (
        (
            Run((Enter(own("one"), 1, large),)),
            Call(1, large),
            Repeat(own("more"), 2, large, Count(), (Call(2, large),)),
        ),
    )
    assert not called.is_large
    itself = program(tmp_path / "itself", "".join(f"string text{n}\n" for n in range(130)))
    assert itself.is_large and [len(group) for group in itself.groups] == [128, 2]


def test_sizes_and_alignments(tmp_path: Path) -> None:
    point, texts = instructions(tmp_path, "geometry_msgs/Point p\nstring[3] t\n")
    assert entry_alignment([point, texts]) == 8 and entry_alignment([texts]) == 4
    assert entry_alignment([]) == 1
    assert following_alignments([texts, point], 1) == [8, 1]
    assert largest_alignment([texts]) == 4 and largest_alignment([texts, point]) == 8
    assert smallest_size([point, texts]) == 24 + 12


def test_only_what_follows_itself_without_padding_is_a_tile(tmp_path: Path) -> None:
    x, y = Value(own("x"), "double"), Value(own("y"), "int8")
    assert tile_of([Run((x, x))]) == Tile((x, x), 8, 16)
    assert tile_of([Run((Blank(),))]) == Tile((Blank(),), 1, 1)
    assert tile_of([Run((x, y))]) is None, "9 bytes: the next one would need padding"
    assert tile_of([Run((y, x))]) is None, "the padding within depends on where it begins"
    assert tile_of([Run((Value(own("c"), "char"),))]) is None, "struct makes bytes of it, not text"
    assert tile_of([Run((Array(own("a"), "double", 2),))]) is None


def test_knowledge_about_positions() -> None:
    known, half = Alignment(8, 5), Alignment(4, 2)
    assert known.advanced(5) == Alignment(8, 2)
    assert known.aligned(4) == Alignment(8, 0) and half.aligned(8) == Alignment(8, 0)
    assert half.aligned(2) == half and not half.is_aligned(4) and half.is_aligned(2)
    assert known.after([(4, 4), (1, 3)]) == Alignment(8, 7) and half.after([(8, 8), (1, 1)]) == Alignment(
        8, 1
    )
    assert known.either(Alignment(8, 1)) == Alignment(4, 1)
    assert known.either(Alignment(8, 2)) == Alignment(1, 0)
    assert half.either(known) == Alignment(1, 0) and half.either(Alignment(8, 6)) == half


def test_who_pads_strings_knows_the_position_after_them() -> None:
    text, start = Text(own("t"), None, wide=False), Alignment(8, 4)
    assert Positions(pads_texts=True).after(text, start, following=4) == Alignment(4, 0)
    assert Positions(pads_texts=True).after(text, start, following=1) == Alignment(1, 0)
    assert Positions(pads_texts=False).after(text, start, following=4) == Alignment(1, 0)


def test_the_head_of_a_loop_holds_before_and_after_each_element() -> None:
    twelve = Run((*coordinates(1, "x"), Value(Slot(1, "_i"), "int32")))
    text = Text(Slot(2, "_t"), None, wide=False)
    start, encoder = Alignment(8, 0), Positions(pads_texts=True)
    assert encoder.head(Repeat(own("a"), 1, POINT, Count(), (twelve,)), start) == Alignment(4, 0)
    named = Repeat(own("b"), 2, NAMED, Count(), (twelve, text))
    assert encoder.head(named, start) == Alignment(4, 0), "the string is padded for the next element"
    assert encoder.after(named, start, following=8) == Alignment(4, 0)
    assert encoder.after(named, start, following=1) == Alignment(1, 0), "and that padding goes at the end"
    assert Positions(pads_texts=False).head(named, start) == Alignment(1, 0)
