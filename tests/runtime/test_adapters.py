"""Adapters: found by the hash of the other version, in one step or several, and used to read its bytes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime import adapters
from ifgen_runtime.adapters import Adapter, AdapterError, adapter_for, decode, register
from ifgen_runtime.codec import deserialize, serialize

NAME = "demo_msgs/msg/Speed"
A = class_from_text(NAME, "float32 value")
B = class_from_text(NAME, "float64 value")
C = class_from_text(NAME, "float64 value\nstring source")
D = class_from_text(NAME, "float64 value\nstring source\nbool valid")

Message = Any


@pytest.fixture(autouse=True)
def _no_adapters(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A registry of their own for each test."""
    monkeypatch.setattr(adapters, "_registered", {})
    monkeypatch.setattr(adapters, "_found", {})
    yield


def a_to_b(old: Message) -> Message:
    return B(value=old.value)


def b_to_a(new: Message) -> Message:
    return A(value=new.value)


def b_to_c(old: Message) -> Message:
    return C(value=old.value, source="wheel")


def c_to_b(new: Message) -> Message:
    return B(value=new.value)


def c_to_d(old: Message) -> Message:
    return D(value=old.value, source=old.source, valid=True)


def test_an_adapter_is_found_by_the_hash_of_the_other_version() -> None:
    adapter = Adapter(A, B, a_to_b, b_to_a, new_hash=B.__type_hash__)
    assert adapter_for(A.__type_hash__, B) is None
    register(adapter)
    assert adapter_for(A.__type_hash__, B) is adapter
    assert adapter_for(A.__type_hash__, C) is None
    assert adapter_for(B.__type_hash__, A) is None


def test_the_adapter_that_was_registered_last_is_used() -> None:
    first, second = (Adapter(A, B, a_to_b) for _ in range(2))
    register(first)
    assert adapter_for(A.__type_hash__, B) is first
    register(second)
    assert adapter_for(A.__type_hash__, B) is second


def test_bytes_of_another_version_are_read() -> None:
    register(Adapter(A, B, a_to_b))
    read = decode(serialize(A(value=0.5)), A.__type_hash__, B)
    assert read == B(value=0.5)
    assert decode(serialize(B(value=0.1)), B.__type_hash__, B) == B(value=0.1)


def test_bytes_without_an_adapter_are_an_error_that_says_what_to_do() -> None:
    digits = A.__type_hash__[7:15]
    with pytest.raises(AdapterError, match=rf"no adapter from {digits} to Speed .*--from {digits}"):
        decode(serialize(A()), A.__type_hash__, B)


def test_adapters_are_chained() -> None:
    register(Adapter(A, B, a_to_b, b_to_a))
    register(Adapter(B, C, b_to_c, c_to_b))
    chain = adapter_for(A.__type_hash__, C)
    assert chain is not None and chain.old is A and chain.new is C and chain.downgrade is not None
    assert chain.upgrade(A(value=0.5)) == C(value=0.5, source="wheel")
    assert chain.downgrade(C(value=0.5)) == A(value=0.5)
    assert decode(serialize(A(value=0.5)), A.__type_hash__, C) == C(value=0.5, source="wheel")


def test_a_chain_without_all_downgrades_has_none() -> None:
    register(Adapter(A, B, a_to_b))
    register(Adapter(B, C, b_to_c, c_to_b))
    chain = adapter_for(A.__type_hash__, C)
    assert chain is not None and chain.downgrade is None


def test_a_chain_goes_through_another_class_of_the_same_version() -> None:
    frozen = class_from_text(NAME, "# the same\nfloat64 value\nuint8 OTHER=1")
    assert frozen is not B and frozen.__type_hash__ == B.__type_hash__

    def upgrade(old: Message) -> Message:
        assert isinstance(old, frozen)
        return b_to_c(old)

    def downgrade(new: Message) -> Message:
        return frozen(value=new.value)

    register(Adapter(A, B, a_to_b, b_to_a))
    register(Adapter(frozen, C, upgrade, downgrade))
    chain = adapter_for(A.__type_hash__, C)
    assert chain is not None and chain.downgrade is not None
    assert chain.upgrade(A(value=0.5)) == C(value=0.5, source="wheel")
    assert chain.downgrade(C(value=0.5)) == A(value=0.5)
    assert adapter_for(A.__type_hash__, frozen) is not None


def test_the_shortest_chain_is_used() -> None:
    register(Adapter(A, B, a_to_b))
    register(Adapter(B, C, b_to_c))
    register(Adapter(C, D, c_to_d))
    register(Adapter(B, D, lambda old: D(value=old.value, source="short")))
    chain = adapter_for(A.__type_hash__, D)
    assert chain is not None and chain.upgrade(A(value=0.5)).source == "short"


def test_circles_are_no_chains() -> None:
    register(Adapter(A, B, a_to_b))
    register(Adapter(B, A, b_to_a))
    assert adapter_for(C.__type_hash__, B) is None
    assert adapter_for("RIHS01_" + "0" * 64, A) is None
    assert adapter_for(B.__type_hash__, B) is None


def test_an_adapter_for_another_version_than_there_is_is_refused() -> None:
    with pytest.raises(AdapterError, match=f"written for Speed {B.__type_hash__[7:15]}, and Speed is"):
        Adapter(A, C, a_to_b, new_hash=B.__type_hash__)


def test_a_part_of_a_service_is_found_by_the_hash_of_the_service_too() -> None:
    old, new = (
        class_from_text("demo_msgs/srv/Add", f"float64 a\n---\n{response}")
        for response in ("float32 sum", "float64 sum")
    )
    same = Adapter(new.Request, new.Request, adapters.unchanged, adapters.unchanged, within=old.__type_hash__)
    response = Adapter(
        old.Response, new.Response, lambda m: new.Response(sum=m.sum), within=old.__type_hash__
    )
    register(same)
    register(response)
    assert adapter_for(old.__type_hash__, new.Request) is same
    assert adapter_for(old.__type_hash__, new.Response) is response
    assert adapter_for(old.Response.__type_hash__, new.Response) is response
    assert decode(serialize(old.Request(a=0.1)), old.__type_hash__, new.Request).a == 0.1
    assert decode(serialize(old.Response(sum=0.5)), old.__type_hash__, new.Response).sum == 0.5


def test_reading_is_what_deserialising_and_upgrading_is() -> None:
    register(Adapter(A, B, a_to_b))
    data = serialize(A(value=0.1))
    assert decode(bytearray(data), A.__type_hash__, B) == a_to_b(deserialize(data, A))
