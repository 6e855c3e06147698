"""What the functions of an adapter do, and what they leave to a person."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from ifgen_runtime.adapters import UndecidedError, adapter_for, decode
from ifgen_runtime.codec import serialize

from tests.cli.conftest import write

from .conftest import Adapt

BATTERY = (
    "uint8 OK=0\nuint8 LOW=1\nstd_msgs/Header header\nfloat32 voltage  # [V]\nfloat32 charge\nuint8 status\n"
)
BATTERY_NOW = (
    "uint8 OK=0\nuint8 LOW=1\nuint8 EMPTY=2\nstd_msgs/Header header\nfloat32 voltage  # [V]\n"
    "float32 current  # [A]\nfloat32 charge\nuint8 level\n"
)


def text(module: ModuleType) -> str:
    return Path(str(module.__file__)).read_text()


def questions(module: ModuleType, name: str = "upgrade") -> list[str]:
    """The questions that a function leaves open."""
    body = text(module).partition(f"\ndef {name}(")[2].partition("\n\n\n")[0]
    return [found.replace('\\"', '"') for found in re.findall(r'^ +"(`.*)",$', body, re.MULTILINE)]


def test_what_is_the_same_is_carried_over(adapt: Adapt) -> None:
    module: Any = adapt({"msg/B.msg": BATTERY}, {"msg/B.msg": BATTERY_NOW}, "msg/B", "--downgrade")
    assert questions(module) == ["`current` [A] is new, and has no default"]
    assert questions(module, "downgrade") == [
        "`new.current` has no field here: use it, or delete this call",
        "`status` has other constants: 2 is EMPTY in `new.level`, and unknown here",
    ]
    assert "        level=old.status,  # was `status`\n" in text(module)


def test_what_is_left_open_says_where_it_is(adapt: Adapt) -> None:
    module: Any = adapt({"msg/B.msg": BATTERY}, {"msg/B.msg": BATTERY_NOW}, "msg/B", "--downgrade")
    [old] = (value for name, value in vars(module).items() if re.fullmatch("B_[0-9a-f]{8}", name))
    with pytest.raises(UndecidedError, match=r"adapters/b_\w+\.py:\d+: `current` \[A\] is new"):
        module.upgrade(old())
    with pytest.raises(UndecidedError, match=r"adapters/b_\w+\.py:\d+: `new.current` has no field here"):
        module.downgrade(module.B())


SAFE = [
    ("int8 a", "int64 a", -3, -3),
    ("uint8 a", "int16 a", 255, 255),
    ("float32 a", "float64 a", 0.5, 0.5),
    ("int32 a", "float64 a", -(2**31), -(2.0**31)),
    ("uint16 a", "float32 a", 65535, 65535.0),
    ("byte a", "uint8 a", b"\x07", 7),
    ("uint8 a", "byte a", 7, b"\x07"),
    ("string<=5 a", "string a", "abcde", "abcde"),
    ("string<=5 a", "wstring<=6 a", "abcde", "abcde"),
    ("float64 a", "float64[] a", 0.1, [0.1]),
    ("string a", "string[1] a", "x", ["x"]),
    ("int16[3] a", "int32[<=5] a", [1, 2, 3], [1, 2, 3]),
    ("float32[] a", "float64[] a", [0.5], [0.5]),
    ("int8[2] a", "float32[2] a", [1, -2], [1.0, -2.0]),
    ("byte[] a", "uint8[] a", [b"\x01"], [1]),
    ("bool[<=2] a", "bool[] a", [True], [True]),
    ("float64 b\nfloat64 a", "float64 a\nfloat64 b", 0.1, 0.1),
    ("float64 b\nuint8 a", 'float64[] more\nuint8 a\nfloat64 b\nstring c "none"', 7, 7),
]


def numbered(texts: Iterable[str]) -> dict[str, str]:
    return {f"msg/T{number}.msg": text for number, text in enumerate(texts)}


def test_what_is_safe_is_converted(adapt: Adapt) -> None:
    names = [f"msg/T{number}" for number in range(len(SAFE))]
    modules = adapt(numbered(old for old, *_ in SAFE), numbered(new for _, new, *_ in SAFE), names)
    for number, (module, (_, _, value, expected)) in enumerate(zip(modules, SAFE, strict=True)):
        assert questions(module) == []
        [before] = (cls for name, cls in vars(module).items() if name.startswith(f"T{number}_"))
        now = getattr(module, f"T{number}")
        made = decode(serialize(before(a=value)), before.__type_hash__, now)
        found = made.a.tolist() if hasattr(made.a, "tolist") else made.a
        assert (found, type(found)) == (expected, type(expected))
        assert made == now(a=expected, **({"c": "none"} if hasattr(made, "c") else {}))


OPEN = [
    (
        "int8 OK=0\nint8 a\nbool x",
        "int8 a",
        "`a` has other constants: 0 is OK in `old.a`, and unknown here",
    ),
    ("int64 a", "int32 a", "`a` is `int32`, and `old.a` is `int64`: does it always fit?"),
    ("float64 a", "float32 a", "`a` is `float32`, and `old.a` is `float64`: does it always fit?"),
    ("int64 a", "float64 a", "`a` is `float64`, and `old.a` is `int64`"),
    ("int8 a", "uint8 a", "`a` is `uint8`, and `old.a` is `int8`"),
    ("bool a", "uint8 a", "`a` is `uint8`, and `old.a` is `bool`"),
    ("string a", "string<=9 a", "`a` is `string<=9`, and `old.a` is `string`: does it always fit?"),
    ("int8[] a", "int8[3] a", "`a` is `int8[3]`, and `old.a` is `int8[]`: does it always fit?"),
    ("int8[3] a", "int8[2] a", "`a` is `int8[2]`, and `old.a` is `int8[3]`"),
    ("int8[] a", "int8 a", "`a` is `int8`, and `old.a` is `int8[]`: does it always fit?"),
    (
        "geometry_msgs/Point a",
        "geometry_msgs/Vector3 a",
        "`a` is `geometry_msgs/Vector3`, and `old.a` is `geometry_msgs/Point`",
    ),
    ("int8 a\nint8 b", "int8 a", "`old.b` has no field here: use it, or delete this call"),
    ("int8 a", "int8 a\nstd_msgs/Header b", "`b` is new, and has no default"),
    ("int8 x\nfloat64 a  # [m]", "float64 a  # [mm]", "`a` is in mm, and `old.a` in m: `old.a * 1000`?"),
    (
        "int8 x\nfloat64 a  # [deg]",
        "float64 a  # [rad]",
        "`a` is in rad, and `old.a` in deg: `math.radians(old.a)`?",
    ),
    ("int8 x\nfloat64 a  # [ms]", "float64 a  # [sec]", "`a` is in sec, and `old.a` in ms: `old.a / 1000`?"),
    ("int8 x\nfloat64 a  # [N]", "float64 a  # [kg]", "`a` is in kg, and `old.a` in N"),
    (
        "int8 OK=0\nint8 LOW=1\nint8 a\nbool x",
        "int8 OK=1\nint8 LOW=0\nint8 a",
        "`a` has other constants: OK is 0 in `old.a`, and 1 here; LOW is 1 in `old.a`, and 0 here",
    ),
    (
        "int8 A_OK=0\nint8 A_BAD=1\nint8 a\nint8 b",
        "int8 A_OK=0\nint8 A_WARN=1\nint8 A_BAD=2\nint8 a",
        "`a` has other constants: A_BAD is 1 in `old.a`, and 2 here",
    ),
]


SAME = [
    ("float64 a  # [A.h]\nint8 b", "float64 a  # [Ah]\nint16 b"),
    ("float64 a\nint8 b", "float64 a  # [m]\nint16 b"),
    ("int8 OK=0\nint8 a\nint8 b", "int8 OK=0\nint8 LOW=1\nint8 a\nint16 b"),
]


def test_what_only_a_person_can_decide_is_left_open(adapt: Adapt) -> None:
    names = [f"msg/T{number}" for number in range(len(OPEN))]
    modules = adapt(numbered(old for old, *_ in OPEN), numbered(new for _, new, _ in OPEN), names)
    for module, (*_, question) in zip(modules, OPEN, strict=True):
        assert question in questions(module)
        others = {f"`old.{name}` has no field here: use it, or delete this call" for name in "bx"}
        assert set(questions(module)) <= {question, *others}


def test_what_means_the_same_is_no_question(adapt: Adapt) -> None:
    names = [f"msg/T{number}" for number in range(len(SAME))]
    modules = adapt(numbered(old for old, _ in SAME), numbered(new for _, new in SAME), names)
    assert [questions(module) for module in modules] == [[]] * len(SAME)


CELL = {"msg/Cell.msg": "float32 voltage  # [V]\n"}
PACK = "Cell main\nCell[] cells\nCell[2] two\nstd_msgs/Header header\n"


def test_messages_in_messages_have_functions_of_their_own(adapt: Adapt) -> None:
    module: Any = adapt(
        {**CELL, "msg/Pack.msg": PACK},
        {"msg/Cell.msg": "float64 voltage  # [V]\n", "msg/Pack.msg": f'{PACK}string name "none"\n'},
        "msg/Pack",
    )
    assert questions(module) == []
    [old] = (cls for name, cls in vars(module).items() if name.startswith("Pack_"))
    [cell] = (cls for name, cls in vars(module).items() if name.startswith("Cell_"))
    made = module.upgrade(
        old(main=cell(voltage=0.5), cells=[cell(voltage=0.25)], two=[cell(), cell(voltage=2.0)])
    )
    assert made == module.Pack(
        main=module.Cell(voltage=0.5),
        cells=[module.Cell(voltage=0.25)],
        two=[module.Cell(), module.Cell(voltage=2.0)],
    )


def test_a_nested_message_that_means_something_else_is_no_silent_copy(adapt: Adapt) -> None:
    """Its hash is the same, so its class is today's."""
    module: Any = adapt(
        {**CELL, "msg/Pack.msg": PACK},
        {"msg/Cell.msg": "float32 voltage  # [mV]\n", "msg/Pack.msg": f'{PACK}string name "none"\n'},
        "msg/Pack",
    )
    question = "`voltage` is in mV, and `old.voltage` in V: `old.voltage * 1000`?"
    assert "def _upgrade_cell(old: Cell) -> Cell:" in text(module)
    assert f'"{question}"' in text(module)


def test_a_message_that_was_renamed_is_the_same(adapt: Adapt) -> None:
    module: Any = adapt(
        {**CELL, "msg/Pack.msg": "Cell[] cells\n"},
        {"msg/Part.msg": CELL["msg/Cell.msg"], "msg/Pack.msg": "Part[] cells\n"},
        "msg/Pack",
    )
    [old] = (cls for name, cls in vars(module).items() if name.startswith("Pack_"))
    [cell] = (cls for name, cls in vars(module).items() if name.startswith("Cell_"))
    assert module.upgrade(old(cells=[cell(voltage=0.5)])) == module.Pack(cells=[module.Part(voltage=0.5)])


def test_names_of_fields_are_said_as_they_are_on_the_other_side(adapt: Adapt) -> None:
    module = adapt(
        {"msg/T.msg": "int8 a\nbool x\n"}, {"msg/T.msg": "int8 b\nint8 x\n"}, "msg/T", "--downgrade"
    )
    assert "        b=old.a,  # was `a`\n" in text(module)
    assert "        a=new.b,  # now `b`\n" in text(module)


def test_a_type_that_had_another_name(adapt: Adapt, tmp_path: Path, ifgen: Any) -> None:
    adapt({"msg/Old.msg": "int8 a\n", "msg/T.msg": "int8 a"}, {"msg/T.msg": "int16 a\n"}, "msg/T")
    done = ifgen("adapt", "robot_msgs/msg/T", "--from", "old:robot_msgs/msg/Old", "-o", "more")
    assert done.code == 0 and [p.name for p in Path("more").glob("_old_*.py")]


def test_services_have_an_adapter_for_each_part(adapt: Adapt) -> None:
    module: Any = adapt(
        {"srv/Add.srv": "int8 a\nint8 b\n---\nint64 sum\n"},
        {"srv/Add.srv": "int16 a\nint16 b\n---\nint64 sum\n"},
        "srv/Add",
        "--downgrade",
    )
    [old] = (cls for name, cls in vars(module).items() if name.startswith("Add_"))
    request = adapter_for(old.__type_hash__, module.Add.Request)
    assert request is adapter_for(old.Request.__type_hash__, module.Add.Request)
    assert request is not None and request.upgrade(old.Request(a=1, b=-2)) == module.Add.Request(a=1, b=-2)
    response = adapter_for(old.__type_hash__, module.Add.Response)
    assert response is not None and response.downgrade is not None
    assert response.downgrade(module.Add.Response(sum=3)) == module.Add.Response(sum=3)
    assert questions(module, "downgrade_request")[0].startswith("`a` is `int8`, and `new.a` is `int16`")


def test_actions_have_an_adapter_for_each_part(adapt: Adapt) -> None:
    module: Any = adapt(
        {"action/Walk.action": "float32 distance\n---\nfloat32 moved\n---\nint8 steps\n"},
        {"action/Walk.action": "float64 distance\n---\nfloat32 moved\n---\nint16 steps\n"},
        "action/Walk",
    )
    [old] = (cls for name, cls in vars(module).items() if name.startswith("Walk_"))
    for part, values in (("Goal", {"distance": 0.5}), ("Feedback", {"steps": 3})):
        cls = getattr(module.Walk, part)
        data = serialize(getattr(old, part)(**values))
        assert decode(data, old.__type_hash__, cls) == cls(**values)
    assert adapter_for(old.__type_hash__, module.Walk.Result) is not None


def test_names_that_are_taken(adapt: Adapt, tmp_path: Path) -> None:
    """Two types of one name, and one that is called as what the module imports."""
    for folder, type_ in (("old", "int8"), ("interfaces", "int16")):
        write(tmp_path / folder / "their_msgs/msg/Adapter.msg", f"{type_} a\n")
        for number in range(6):
            write(tmp_path / folder / f"their_msgs/msg/ALongNameOfAType{number}.msg", f"{type_} a\n")
    others = "".join(f"their_msgs/ALongNameOfAType{number} x{number}\n" for number in range(6))
    text = f"their_msgs/Adapter first\nAdapter second\n{others}"
    old, new = ({"msg/Adapter.msg": f"{type_} b\n", "msg/T.msg": text} for type_ in ("int32", "int64"))
    module: Any = adapt(old, new, "msg/T")
    assert questions(module) == []
    made = module.upgrade(next(cls for name, cls in vars(module).items() if name.startswith("T_"))())
    assert (made.first.a, made.second.b) == (0, 0)
    importlib.import_module(f"adapters.test_adapt_{module.__name__.partition('.')[2]}")
