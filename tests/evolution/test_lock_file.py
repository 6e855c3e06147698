"""The lock file: the definitions that come back are those that went in, and each mistake is one error."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen.definition.interfaces import Constant, Field, Registry
from ifgen.definition.type_description import TypeHashes, described_types
from ifgen.diagnostics import Diagnostic, InputError, Source
from ifgen.evolution.lock import file as lock_file
from ifgen.evolution.lock import text as lock_text
from ifgen.pipeline import stages

ROOT = Path(__file__).resolve().parents[2]

ODD = {
    "odd_msgs/msg/Text.msg": "string a 'say \"ö\" x'\nwstring<=5[<=5] b\nstring[] c ['x-1', 'y z']\nstring K=' a=b '",
    "odd_msgs/msg/Number.msg": "float32 a -0.1\nbyte b 255\nchar c 97\nbool[2] d [true, false]\nint64 MIN=-9223372036854775808",
    "odd_msgs/msg/Empty.msg": "",
    "odd_msgs/msg/Held.idl": "module odd_msgs { module msg { module Held_Constants { const char LETTER = 65; };"
    " struct Held { char Letter; @default(value=66) char other; sequence<wstring<4>> names;"
    " sequence<odd_msgs::msg::Text, 3> texts; }; }; };",
    "odd_msgs/srv/Ask.srv": "Text text\n---\nuint8 OK=0\nuint8 code 1",
    "odd_msgs/action/Go.action": "float64 x 0.1\n---\nText text\n---\n",
}


@pytest.fixture(scope="module")
def bundled() -> Registry:
    return stages.load(*(path for path in (ROOT / "interfaces").iterdir() if path.is_dir()))


@pytest.fixture
def odd(tmp_path: Path) -> Registry:
    for name, text in ODD.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    return stages.load(tmp_path / "odd_msgs")


def parse(text: str) -> lock_file.Lock:
    return lock_file.parse(Source(Path("ifgen.lock"), text))


def mistake(text: str) -> Diagnostic:
    with pytest.raises(InputError) as caught:
        parse(text)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.rule == "invalid-lock"
    assert diagnostic.help
    assert len(diagnostic.message) < 200
    return diagnostic


def parts(registry: Registry) -> Iterator[tuple[str, object]]:
    for interface in registry:
        for part in lock_text.written_parts(interface):
            for item in lock_text.definitions(part):
                value = item.value if isinstance(item, Constant) else item.default_value
                yield part.type_name, (item.name, item.type, value)


@pytest.mark.parametrize("which", ["bundled", "odd"])
def test_what_is_read_is_what_was_written(which: str, request: pytest.FixtureRequest) -> None:
    registry: Registry = request.getfixturevalue(which)
    text = lock_text.text([registry])
    lock = parse(text)
    assert lock_text.text([lock.registry]) == text
    assert sorted(parts(lock.registry), key=repr) == sorted(parts(registry), key=repr)
    before, after = TypeHashes(registry), TypeHashes(lock.registry)
    for interface in registry:
        for one, other in zip(
            described_types(interface),
            described_types(lock.registry.interface(interface.type_name)),
            strict=True,
        ):
            assert after.of(other) == before.of(one)
        assert lock.hashes[interface.type_name] == before.of(interface)


def test_the_places_are_those_in_the_file(odd: Registry) -> None:
    lock = parse(lock_text.text([odd]))
    for interface in lock.registry:
        for part in lock_text.written_parts(interface):
            assert part.span is not None
            assert part.type_name.endswith(lock.source.text[part.span.start : part.span.end])
            for item in lock_text.definitions(part):
                assert item.span is not None
                assert lock.source.text[item.span.start : item.span.end] == item.name
                assert isinstance(item, Constant) or is_before(item)


def is_before(field: Field) -> bool:
    assert field.span is not None
    assert field.type_span is not None
    return field.type_span.line == field.span.line and field.type_span.end == field.span.start - 1


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("good") / "demo_msgs"
    for name, text in (
        ("msg/Inner.msg", "float64 x 0.1\n"),
        ("msg/Outer.msg", "Inner[<=3] inner\nuint8 FAST=1\n"),
        ("srv/Ask.srv", "Outer outer\n---\n"),
    ):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return lock_text.text([stages.load(folder)])


def test_an_edited_field_is_found_by_the_hash_of_its_own_type(good: str) -> None:
    found = mistake(good.replace("float64 x 0.1", "float32 x 0.1"))
    assert found.message == "the hash of demo_msgs/msg/Inner does not fit its definition here"
    assert found.primary is not None
    assert found.primary.span.source.line(found.primary.span.line).startswith("demo_msgs/msg/Inner RIHS01_")


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        (
            "version 1",
            "version 2",
            "this ifgen reads version 1 of lock files, and this is version 2",
            "version 2",
        ),
        ("version 1\n", "", "a lock file begins with `version 1`", "builtin_interfaces/msg/Time"),
        ("\nend\n", "\n", "the file is cut off: its last line is not `end`", ""),
        ("end\n", "end\nmore\n", "there is text after the end", "more"),
        (
            "demo_msgs/msg/Inner RIHS01_",
            "demo_msgs/msg/Inner RIHS02_",
            "expected the type hash of",
            "demo_msgs/msg/Inner",
        ),
        ("demo_msgs/msg/Inner R", "demo_msgs/Inner R", "expected an interface, such as", "demo_msgs/Inner"),
        ("    float64 x 0.1", "<<<<<<< HEAD", "this is the marker of a merge conflict", "<<<<<<< HEAD"),
        ("    float64 x 0.1", "    float128 x 0.1", "`float128` is not a type", "    float128"),
        ("    float64 x 0.1", "    float64 x zero", "this is no value of its type", "    float64 x zero"),
        ("    float64 x 0.1", "    float64 x 1", "this is no value of its type", "    float64 x 1"),
        ("    float64 x 0.1", "    float64 _x", "expected a field `TYPE NAME`", "    float64 _x"),
        (
            "    float64 x 0.1",
            "    float64 x\n    float64 x",
            "Inner has two definitions of 'x'",
            "    float64 x",
        ),
        ("    float64 x 0.1", "    demo_msgs/Other x", "needs demo_msgs/msg/Other", "    demo_msgs/Other x"),
        ("    uint8 FAST=1", "    uint8[2] FAST=[1, 2]", "a constant has a basic type", "    uint8[2] FAST"),
        ("    uint8 FAST=1", "    uint8 FAST=256", "this is no value of its type", "    uint8 FAST=256"),
        ("  Ask_Response R", "  Ask_Answer R", "expected the part `Ask_Response RIHS01_...`", "  Ask_Answer"),
        ("[<=3] inner", "[<=99999999999999999999999] inner", "is not a type", "    demo_msgs/Inner[<=9999"),
    ],
)
def test_each_mistake_is_one_error_with_its_line(
    good: str, old: str, new: str, message: str, line: str
) -> None:
    assert old in good
    found = mistake(good.replace(old, new, 1))
    assert message in found.message
    assert found.primary is not None
    assert found.primary.span.source.line(found.primary.span.line).startswith(line)


def test_a_cycle_is_an_error(good: str) -> None:
    found = mistake(good.replace("    float64 x 0.1", "    demo_msgs/Outer x", 1))
    assert "contains itself" in found.message


def test_a_file_that_ends_anywhere_is_cut_off_or_wrong(good: str) -> None:
    for size in range(0, len(good) - 1, 7):
        mistake(good[:size])


def test_any_edit_is_harmless_or_one_error(good: str) -> None:
    """Every text is read or refused; what is read has the hashes that it says."""
    rng = random.Random(1)
    words = [
        *good.split(),
        "\n",
        " ",
        "=",
        "    ",
        "9" * 5000,
        "[" * 2000,
        "\x85",
        "\u2028",
        "\0",
        "é",
        "end",
    ]
    read = 0
    for _ in range(600):
        text = good
        for _ in range(rng.choice((1, 1, 2, 5))):
            start = rng.randrange(len(text))
            text = text[:start] + rng.choice(words) + text[start + rng.choice((0, 1, 3, 40)) :]
        try:
            lock = parse(text)
        except InputError as error:
            (diagnostic,) = error.diagnostics
            assert diagnostic.rule == "invalid-lock"
            continue
        read += 1
        hashes = TypeHashes(lock.registry)
        assert all(lock.hashes[interface.type_name] == hashes.of(interface) for interface in lock.registry)
    assert read < 300
