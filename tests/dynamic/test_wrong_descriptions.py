"""Descriptions come from other machines: each mistake is one error, and nothing in them is executed."""

from __future__ import annotations

import builtins
import copy
import json
import random
import time
from collections.abc import Callable
from typing import Any

import ifgen.dynamic
import pytest
from ifgen.definition.described.reading import read
from ifgen.definition.type_description import describe
from ifgen.pipeline import stages
from ifgen_runtime.codec import deserialize, serialize

from tests.dynamic.test_classes import FOLDERS

Document = dict[str, Any]


@pytest.fixture(scope="module")
def documents() -> dict[str, Document]:
    registry = stages.load(*FOLDERS)
    return {interface.type_name: describe(interface, registry) for interface in registry}


@pytest.fixture
def pose(documents: dict[str, Document]) -> Document:
    return copy.deepcopy(documents["geometry_msgs/msg/PoseStamped"])


def error_of(description: object, type_hash: str | None = None) -> str:
    with pytest.raises(ifgen.dynamic.InputError) as caught:
        ifgen.dynamic.class_of(description, type_hash)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.rule == "invalid-description"
    assert len(diagnostic.message) < 300
    return diagnostic.message


def field(document: Document, number: int = 0) -> Document:
    found: Document = document["type_description"]["fields"][number]
    return found


def test_a_description_that_lies(documents: dict[str, Document], pose: Document) -> None:
    wrong = "RIHS01_" + 64 * "0"
    assert "does not fit its type hash RIHS01_000000" in error_of(pose, wrong)
    swapped = copy.deepcopy(pose)
    swapped["type_description"]["fields"].reverse()
    good = ifgen.dynamic.class_of(pose).__type_hash__
    assert "does not fit" in error_of(swapped, good)
    assert ifgen.dynamic.class_of(pose, good)


def other_types(document: Document, count: int) -> None:
    document["referenced_type_descriptions"] += [
        {"type_name": f"a_msgs/msg/A{number}", "fields": []} for number in range(count)
    ]


def nested(document: Document, levels: int) -> None:
    of = {"type_id": 1, "capacity": 0, "string_capacity": 0}
    names = [f"a_msgs/msg/A{number}" for number in range(levels)]
    field(document, 1)["type"]["nested_type_name"] = names[0]
    document["referenced_type_descriptions"] += [
        {
            "type_name": name,
            "fields": [{"name": "a", "type": {**of, "nested_type_name": inner}, "default_value": ""}],
        }
        for name, inner in zip(names, [*names[1:], "geometry_msgs/msg/Pose"], strict=True)
    ]


def squared(document: Document) -> None:
    """Arrays of arrays of arrays."""
    nested(document, 12)
    for item in document["referenced_type_descriptions"][-12:]:
        item["fields"][0]["type"] |= {"type_id": 49, "capacity": 1000}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.pop("type_description"), "has no key 'type_description'"),
        (lambda d: d.pop("referenced_type_descriptions"), "has no key 'referenced_type_descriptions'"),
        (lambda d: d.update(type_description=[]), "is not a dictionary, but a list"),
        (lambda d: d["type_description"].update(type_name="PoseStamped"), "is not the name of a type"),
        (lambda d: d["type_description"].update(type_name="import/msg/A"), "is not the name of a type"),
        (lambda d: d["type_description"].update(type_name="a_msgs/msg/None"), "is not the name of a type"),
        (lambda d: d["type_description"].update(type_name="a_msgs/msg/A\n"), "is not the name of a type"),
        (lambda d: d["type_description"].update(type_name="a_msgs/msg/" + "A" * 300), "is not the name of a"),
        (lambda d: d["type_description"].update(fields={}), "expected a list, not a dict"),
        (lambda d: field(d).update(name="__class__"), "'__class__' cannot be the name of a field"),
        (lambda d: field(d).update(name="a b"), "'a b' cannot be the name of a field"),
        (lambda d: field(d).update(name="ö"), "cannot be the name of a field"),
        (lambda d: field(d).update(name="SLOT_TYPES"), "needs the name `SLOT_TYPES`"),
        (lambda d: field(d).update(name="pose"), "has two fields 'pose'"),
        (lambda d: field(d).update(name=3), "expected a string, not a int"),
        (lambda d: field(d)["type"].update(type_id=12), "type id 12, which no ROS message has"),
        (lambda d: field(d)["type"].update(type_id=193), "type id 193"),
        (lambda d: field(d)["type"].update(type_id=0), "type id 0"),
        (lambda d: field(d)["type"].update(type_id=2**70), "has no number for 'type_id'"),
        (lambda d: field(d)["type"].update(type_id=True), "has no number for 'type_id'"),
        (lambda d: field(d)["type"].update(capacity=3), "and the capacity 3"),
        (lambda d: field(d)["type"].update(type_id=49), "and the capacity 0"),
        (lambda d: field(d)["type"].update(string_capacity=3), "and the string capacity 3"),
        (lambda d: field(d)["type"].update(type_id=8), "and the nested type 'std_msgs/msg/Header'"),
        (lambda d: field(d)["type"].update(nested_type_name="a/b"), "which no ROS message has"),
        (
            lambda d: field(d)["type"].update(nested_type_name="a/msg/B"),
            "is a a/msg/B, which is not described",
        ),
        (
            lambda d: field(d)["type"].update(nested_type_name="geometry_msgs/msg/PoseStamped"),
            "contains itself",
        ),
        (lambda d: field(d).update(default_value="1"), "cannot have the default '1'"),
        (lambda d: d["referenced_type_descriptions"].append(d["type_description"]), "is described twice"),
        (lambda d: d["referenced_type_descriptions"].pop(), "which is not described"),
        (lambda d: other_types(d, 1001), "has 1007 types; the limit is 1000"),
        (lambda d: nested(d, 900), "is nested more than 64 levels deep"),
        (squared, "has more than 134217728 values"),
        (
            lambda d: field(d)["type"].update(type_id=48 + 3, capacity=2**63, nested_type_name=""),
            "has more than 134217728 values",
        ),
    ],
)
def test_each_mistake_is_one_error(
    pose: Document, change: Callable[[Document], object], message: str
) -> None:
    change(pose)
    assert message in error_of(pose)


@pytest.mark.parametrize(
    "description",
    [
        None,
        3,
        "",
        "{",
        "[]",
        "null",
        b"\xff",
        "[" * 100_000,
        object(),
        {},
        {"type_description_msg": 1},
        "1" * 5000,
    ],
)
def test_what_is_no_description_at_all(description: object) -> None:
    error_of(description)


@pytest.mark.parametrize(
    ("type_id", "text"),
    [
        (6, "1.5"),
        (3, "256"),
        (3, "1 + 1"),
        (3, "__import__('os').system('true')"),
        (15, "1"),
        (11, "nan"),
        (11, "1e999"),
        (11, "9" * 5000),
        (48 + 17, "(1, 2)"),
        (48 + 17, "('a',)"),
        (48 + 17, "(" * 5000),
        (48 + 17, "__import__('os')"),
        (48 + 6, "(1, 2, 3)"),
        (48 + 6, "[1, 2]"),
        (17, "a\0b"),
    ],
)
def test_defaults_are_values_and_not_code(pose: Document, type_id: int, text: str) -> None:
    capacity = 2 if type_id > 48 else 0
    field(pose)["type"] = {
        "type_id": type_id,
        "capacity": capacity,
        "string_capacity": 0,
        "nested_type_name": "",
    }
    field(pose)["default_value"] = text
    assert "cannot have the default" in error_of(pose)


EVIL = [
    "x: int = print('executed')",
    "x'); import os; os._exit(3) #",
    '"""',
    "x\n    import os",
    "__init__",
    "__slots__",
    "mro",
    "_check_fields",
    "self",
    "check_fields",
    "class",
    "None",
    "lambda",
    "get_fields_and_field_types",
    "SLOT_TYPES",
    "\uff41",
    "x" * 300,
    "Metaclass_PoseStamped",
    "TYPE_CHECKING",
    "MessageMeta",
    "Exception",
    "DEFAULT",
    "numpy",
    "m",
    "x1",
    "os/msg/System",
    "builtins/msg/Exception",
    "ifgen_runtime/msg/Codec",
    "a_msgs/msg/TYPE_CHECKING",
    "a_msgs/msg/Exception",
    "a_msgs/srv/MessageMeta",
    "../msg/A",
    "",
    "a/b/c/d",
    0,
    -1,
    2**64,
    145,
    None,
    [],
    {},
    True,
    1.5,
]


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """All places in a document."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, item in items for place in places(item, (*path, key)))]


def changed(document: Document, rng: random.Random) -> Document:
    document = copy.deepcopy(document)
    for _ in range(rng.choice((1, 1, 2, 4))):
        *path, last = rng.choice([place for place in places(document) if place])
        holder: Any = document
        for key in path:
            holder = holder[key]
        kind = rng.random()
        if kind < 0.15:
            del holder[last]
        elif kind < 0.3 and isinstance(holder, list):
            holder.insert(rng.randrange(len(holder) + 1), copy.deepcopy(holder[last]))
        elif kind < 0.4 and isinstance(holder, list):
            rng.shuffle(holder)
        else:
            holder[last] = copy.deepcopy(rng.choice(EVIL))
    return document


def test_any_change_is_one_error_or_a_class_that_works(
    documents: dict[str, Document], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is accepted has the hash of what it says, and can be sent; nothing else ever happens."""
    monkeypatch.setattr(builtins, "print", lambda *_: pytest.fail("a description was executed"))
    rng = random.Random(1)
    names = sorted(documents)
    start = time.process_time()
    made = 0
    for _ in range(1500):
        document = changed(documents[rng.choice(names)], rng)
        try:
            described, _ = read(document)
        except ifgen.dynamic.InputError as error:
            assert [d.rule for d in error.diagnostics] == ["invalid-description"]
            continue
        if made < 60 and type(described).__name__ == "Message":
            cls = ifgen.dynamic.class_of(document)
            made += 1
            assert deserialize(serialize(cls()), cls) == cls()
            assert json.dumps(document)
    assert made == 60
    assert time.process_time() - start < 60


@pytest.mark.parametrize("name", [name for name in EVIL if isinstance(name, str)])
def test_an_odd_name_is_refused_or_works(pose: Document, name: str) -> None:
    for change in (
        lambda d: field(d).update(name=name),
        lambda d: d["type_description"].update(type_name=name if "/" in name else f"a_msgs/msg/{name}"),
        lambda d: d["type_description"].update(type_name=f"{name}/msg/A"),
    ):
        document = copy.deepcopy(pose)
        change(document)
        try:
            cls = ifgen.dynamic.class_of(document)
        except ifgen.dynamic.InputError as error:
            assert [d.rule for d in error.diagnostics] == ["invalid-description"]
            continue
        assert "__serialize__" in vars(cls)
        assert deserialize(serialize(cls()), cls) == cls()
        assert copy.deepcopy(cls()) == cls()
        assert repr(cls())
