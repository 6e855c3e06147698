"""Type descriptions and type hashes equal those that the wheels ship with their interfaces."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ifgen import resources
from ifgen.definition.interfaces import Registry
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import Described, describe, described_types, type_hash
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

SHARE = Path(sys.prefix) / "share"


def _shipped() -> Iterator[dict[str, Any]]:
    for path in sorted(SHARE.glob("*/*/*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        if "type_description_msg" in document:
            yield document


@pytest.fixture(scope="module")
def shipped() -> list[dict[str, Any]]:
    """The .json files of all types in the wheels; skips if they are missing."""
    documents = list(_shipped())
    if not documents:
        pytest.skip("the wheels' interfaces are not installed")
    return documents


def _described(registry: Registry) -> dict[str, Described]:
    return {d.type_name: d for interface in registry for d in described_types(interface)}


@pytest.fixture(scope="module", params=["the wheels' files", "the bundled files"])
def registry(request: pytest.FixtureRequest) -> Registry:
    """All definitions of the wheels' files and of ours, which are the same."""
    folder = SHARE if request.param == "the wheels' files" else resources.bundled_interfaces()
    packages = find_packages([folder])
    return resolve(packages, SearchPath(packages))


def test_equal_what_the_wheels_ship(registry: Registry, shipped: list[dict[str, Any]]) -> None:
    """The documents are equal, including the order of keys, and so are the hashes of everything referred to."""
    described = _described(registry)
    hashes: dict[str, str] = {}
    for document in shipped:
        expected = document["type_description_msg"]
        name = expected["type_description"]["type_name"]
        if name in described:
            assert json.dumps(describe(described[name], registry)) == json.dumps(expected)
            hashes.update((item["type_name"], item["hash_string"]) for item in document["type_hashes"])
    assert {name: type_hash(described[name], registry) for name in hashes} == hashes
    assert len(hashes) == 307, "all of the wheels' types are bundled"


def test_every_type_of_the_wheels_is_known(shipped: list[dict[str, Any]]) -> None:
    """307 types are described by the wheels' files, derived ones included, and by us."""
    packages = find_packages([SHARE])
    known = _described(resolve(packages, SearchPath(packages)))
    names = {item["type_name"] for document in shipped for item in document["type_hashes"]}
    assert names <= known.keys()
    assert len(names) == 307


@pytest.mark.parametrize(
    ("name", "digits"),
    [
        ("std_msgs/msg/Char", "3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9"),
        ("std_msgs/msg/String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"),
        ("std_msgs/msg/Header", "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"),
        (
            "example_interfaces/srv/AddTwoInts",
            "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a",
        ),
        (
            "example_interfaces/srv/AddTwoInts_Event",
            "32c1d140259c71e5c355115942bcb31df98b4330e4d906b1b75ccb1c9b3ce6c8",
        ),
        (
            "example_interfaces/action/Fibonacci",
            "9508051da1ea4658de144b09bd0690ff3de52104683d847aed764d2915906f51",
        ),
        (
            "example_interfaces/action/Fibonacci_GetResult_Response",
            "6021dc98ab9b4bbe395e48aa4de81ee5f68eb570f88358affcc648146668b24f",
        ),
        (
            "example_interfaces/action/Fibonacci_FeedbackMessage",
            "c1de71afd52e49a89c53d8262366884185bc0a02f78ce051c4e46b0a7fe59bb2",
        ),
        ("rmw_dds_common/msg/Gid", "ab6f21cfbb0a6dbb837161e1110c2051a2850ed9f9c53944d7115d9bcebedf71"),
        (
            "rmw_dds_common/msg/ParticipantEntitiesInfo",
            "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e",
        ),
    ],
)
def test_known_hashes(name: str, digits: str) -> None:
    """Hashes measured on a ROS 2 Jazzy machine, also without the wheels."""
    packages = find_packages([resources.bundled_interfaces()])
    registry = resolve(packages, SearchPath(packages))
    assert type_hash(_described(registry)[name], registry) == f"RIHS01_{digits}"


# Only Kilted's test_msgs has these, so that they are not bundled: other tests run on Jazzy's test_msgs.
KEYED = {
    "KeyedLong": (
        "@key long key; long value;",
        "660defa556c3c4b1991498e62bca58bf71ac6e13bcf9a476aa998a8b66f650f0",
    ),
    "KeyedString": (
        "@key string key; string value;",
        "20c0320c41013bc51612123c18abadac81944a31db59f1caf817829e2f186043",
    ),
    "NonKeyedWithNestedKey": (
        "test_msgs::msg::KeyedString nested_data; int32 some_int;",
        "36baf7e933c8647ccf6a96e27549df0db4c6d5bc0200819dab4c61e6b6d927d2",
    ),
    "ComplexNestedKey": (
        "@key uint32 uint32_key; @key test_msgs::msg::NonKeyedWithNestedKey nested_keys; double float64_value;",
        "67de37f251f9431ed5f2630507939ff5538ecfaaa4169849be18870c3fbe2de8",
    ),
}


def test_types_with_keys_have_the_hashes_of_kilted(tmp_path: Path) -> None:
    (tmp_path / "test_msgs/msg").mkdir(parents=True)
    for name, (members, _) in KEYED.items():
        text = f"module test_msgs {{ module msg {{ struct {name} {{ {members} }}; }}; }};\n"
        (tmp_path / f"test_msgs/msg/{name}.idl").write_text(text)
    packages = find_packages([tmp_path])
    registry = resolve(packages, SearchPath(packages))
    described = _described(registry)
    hashes = {name: type_hash(described[f"test_msgs/msg/{name}"], registry) for name in KEYED}
    assert hashes == {name: f"RIHS01_{digits}" for name, (_, digits) in KEYED.items()}
