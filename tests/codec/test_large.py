"""Messages of many fields and levels: their code grows linearly with their definitions, and works the same."""

from __future__ import annotations

import ast
import ctypes
import gc
import sys
from array import array
from collections.abc import Iterator
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

import ifgen
import ifgen_runtime.codec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.definition.interfaces import Registry
from ifgen.generator_py.codec.text import CodecText, render
from ifgen.generator_py.names import slot_name
from ifgen.wire import plan as planning
from ifgen.wire.plan import Extents, plan

from .strategies import messages
from .support import OWN_INTERFACES, Classes, generate
from .test_round_trip import CORNERS, check

MIXED = (
    *("int8", "float64", "string", "bool", "uint16", "geometry_msgs/Point", "float64[]", "string<=4"),
    *("int32[3]", "geometry_msgs/Pose[]", "std_msgs/Header[]", "byte[2]", "wstring", "bool[]"),
)


def write(folder: Path, **definitions: str) -> Path:
    """A package `large_msgs` of messages."""
    (folder / "large_msgs" / "msg").mkdir(parents=True)
    for name, text in definitions.items():
        (folder / "large_msgs" / "msg" / f"{name}.msg").write_text(text)
    return folder / "large_msgs"


def fields(count: int, *types: str) -> str:
    return "".join(f"{types[index % len(types)]} f{index}\n" for index in range(count))


def planned(registry: Registry, name: str) -> CodecText:
    return render(plan(registry.message(f"large_msgs/msg/{name}"), Extents(registry), slot_name))


def size(codec: CodecText) -> int:
    return sum(map(len, (*codec.constants, codec.serialize, codec.deserialize, codec.attachment)))


# A limit so low that almost every message is split off and called, and each array of messages too.
@pytest.fixture(
    scope="module",
    params=[
        pytest.param(("MOST_STEPS", 2), id="MOST_STEPS"),
        pytest.param(("MOST_LOOPS", 0), id="MOST_LOOPS", marks=pytest.mark.slow),
    ],
)
def cut(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Classes:
    """The classes of codec_msgs and their dependencies, as if most of them were large."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(planning, *request.param)
        return generate(tmp_path_factory.mktemp("cut"), OWN_INTERFACES)


@settings(max_examples=100)
@given(data=st.data())
def test_large_messages_are_as_others_on_the_wire(cut: Classes, data: st.DataObject) -> None:
    cls = cut[f"codec_msgs/msg/{data.draw(st.sampled_from(CORNERS))}"]
    assert hasattr(cls, "__write__") or cls.__name__ not in ("Deep", "Shifting")
    check(data.draw(messages(cls)))


@settings(max_examples=50)
@given(data=st.data())
def test_classes_without_functions_for_parts(without_parts: Classes, data: st.DataObject) -> None:
    """Classes that rosidl compiled have no such functions."""
    cls = without_parts[f"codec_msgs/msg/{data.draw(st.sampled_from(CORNERS))}"]
    check(data.draw(messages(cls)))


@pytest.fixture(scope="module")
def without_parts(tmp_path_factory: pytest.TempPathFactory) -> Classes:
    """The classes of codec_msgs without the functions that write or read them as a part."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(planning, "MOST_STEPS", 2)
        patch.setattr(ifgen_runtime.codec, "attach_parts", lambda *_: None)
        return generate(tmp_path_factory.mktemp("without"), OWN_INTERFACES)


@pytest.mark.parametrize(
    "types",
    [
        MIXED,
        *(
            pytest.param(types, marks=pytest.mark.slow)
            for types in [
                ("float64",),
                ("int8", "float64"),
                ("string",),
                ("string", "int32"),
                ("float64[3]",),
            ]
        ),
    ],
    ids=lambda types: "mixed" if len(types) > 2 else "-".join(types),
)
def test_planning_is_linear_in_the_fields(tmp_path: Path, types: tuple[str, ...]) -> None:
    """Four times the fields lead to four times the text and four times the calls of Python functions."""
    registry = ifgen.load(write(tmp_path, Some=fields(500, *types), Many=fields(2000, *types)))
    some, calls_of_some = counted(registry, "Some")
    many, calls_of_many = counted(registry, "Many")
    assert size(many) < 4.5 * size(some)
    assert calls_of_many < 4.5 * calls_of_some


def counted(registry: Registry, name: str) -> tuple[CodecText, int]:
    """A codec, and the number of calls of Python functions that planned it."""
    calls = 0

    def count(frame: Any, event: str, argument: Any) -> None:
        nonlocal calls
        calls += event == "call"

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        return planned(registry, name), calls
    finally:
        sys.setprofile(before)


@pytest.mark.parametrize("field", ["{} {}", "{}[] {}", "{}[1] {}"])
def test_text_does_not_grow_with_the_depth(tmp_path: Path, field: str) -> None:
    """Each level has two fields of the previous one: without a limit to inlining, 2 ** 24 at the top."""
    levels = {
        f"Level{n}": "".join(field.format(f"Level{n - 1}", x) + "\n" for x in "ab") for n in range(1, 25)
    }
    registry = ifgen.load(write(tmp_path, Level0="float64 a\nstring b\n", **levels))
    sizes = [size(planned(registry, name)) for name in ("Level0", *levels)]
    assert max(sizes[12:]) <= max(sizes[:12])
    assert max(sizes) < 150_000


def test_long_chains(tmp_path: Path) -> None:
    """Messages nested in each other, deeper than Python's stack."""
    chain = {f"Link{n}": f"Link{n - 1} below\n" for n in range(1, 1200)}
    registry = ifgen.load(write(tmp_path, Link0="int32 x\n", **chain))
    assert "_write_Link1199" not in planned(registry, "Link1199").serialize
    assert any("writer_of" in line for line in planned(registry, "Link1199").constants)


def test_sequences_nested_deeper_than_python_nests_loops(tmp_path: Path) -> None:
    levels = {f"Level{n}": f"string text\nLevel{n - 1}[] below\n" for n in range(1, 30)}
    registry = ifgen.load(write(tmp_path, Level0="string text\n", **levels))
    for name in levels:
        codec = planned(registry, name)
        compile(codec.serialize, "serialize", "exec")
        compile(codec.deserialize, "deserialize", "exec")
        assert "for " in codec.serialize and "for " in codec.deserialize


def test_no_function_is_long(tmp_path: Path) -> None:
    """Python compiles long functions in a time that grows faster than they do."""
    registry = ifgen.load(write(tmp_path, Many=fields(1000, *MIXED)))
    codec = planned(registry, "Many")
    for text in (codec.serialize, codec.deserialize):
        functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
        assert len(functions) > 1000 / planning.MOST_STEPS
        lengths = [sum(isinstance(node, ast.stmt) for node in ast.walk(function)) for function in functions]
        assert max(lengths) < 5 * planning.MOST_STEPS


@pytest.fixture
def memory_returned() -> Iterator[None]:
    """Return the memory that Python's compiler freed: 1 GB for 20,000 fields, which glibc would keep."""
    yield
    gc.collect()
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)


@pytest.mark.usefixtures("memory_returned")
@pytest.mark.parametrize("count", [700, pytest.param(20_000, marks=pytest.mark.slow)])
def test_all_of_a_large_class_works(tmp_path: Path, count: int) -> None:
    """A class of 20,000 fields, the most that ifgen reads, works."""
    package = write(tmp_path / "in", Many=fields(count, *MIXED), Holder="Many one\nMany[] more\nint8 end\n")
    classes = generate(tmp_path / "out", package)
    many, holder = classes["large_msgs/msg/Many"], classes["large_msgs/msg/Holder"]
    filled = many(f0=-1, f1=0.1, f2="Grüße", f6=[0.1, 2.0], f8=[1, 2, 3], f9=[], f13=[True])
    check(holder(one=filled, more=[many(), filled], end=3))
    assert deepcopy(filled) == filled != many()
    shown = repr(filled)
    assert shown.startswith(
        "large_msgs.msg.Many(f0=-1, f1=0.1, f2='Grüße', f3=False, f4=0, f5=geometry_msgs.msg."
    )
    assert "f6=[0.1, 2.0], f7='', f8=array([1, 2, 3], dtype=int32), f9=[]," in shown
    assert shown.count(" f") == count - 1 and shown.endswith(")")
    assert filled.f6 == array("d", [0.1, 2.0])
    checked = many(check_fields=True)
    with pytest.raises(AssertionError):
        checked.f0 = 1000
