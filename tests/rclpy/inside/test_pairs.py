"""Live pairs of the bundled interfaces and edits of them: explained with the right rule, and no garbage."""

from __future__ import annotations

import contextlib
import itertools
import random
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import ifgen as toolkit
import pytest
import rclpy
from ifgen.cli.evolution.explain import explain
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.codec import serialize
from ifgen_runtime.errors import SerializationError
from ifgen_runtime.mismatch import reporting
from rclpy.node import Node
from rclpy.parameter import Parameter
from rmw_local import report

from tests.evolution.corpus import Edit, edits, messages

pytestmark = pytest.mark.slow  # the widest sample of pairs; `contract` has something of each
ROOT = Path(__file__).resolve().parents[3]
NAME = "edited_msgs/msg/Edited"
EACH = 2  # edits of each rule
SAMPLES = (0.1, 7, "text", True, b"\x07", [0.5, 0.25], [1, 2], ["a"], [True])

Message = Any
_numbers = itertools.count()


def some_edits() -> list[Edit]:
    chance = random.Random(14)
    registry = toolkit.load(ROOT / "interfaces")
    of_rules: dict[str | None, list[Edit]] = {}
    for message in messages(registry):
        for edit in edits(message, chance):
            of_rules.setdefault(edit.rule, []).append(edit)
    return [edit for found in of_rules.values() for edit in chance.sample(found, EACH)]


@pytest.fixture(scope="module")
def pairs() -> list[tuple[Edit, Any, Any]]:
    return [
        (edit, *(class_from_text(NAME, "".join(map(str, lines))) for lines in (edit.before, edit.after)))
        for edit in some_edits()
    ]


@pytest.fixture
def said(no_adapters: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """The warnings, by the toolkit, installed or not."""
    monkeypatch.setattr(reporting, "explanation", lambda mismatch: explain(asdict(mismatch)))
    texts: list[str] = []
    monkeypatch.setattr(report, "say", lambda node, text, is_warning=True: texts.append(text))
    rclpy.init()
    yield texts
    rclpy.shutdown()


def filled(cls: Any) -> Message:
    """A message whose fields hold something, where one of the samples fits."""
    message = cls()
    for name in cls.get_fields_and_field_types():
        default = getattr(message, name)
        for sample in (*SAMPLES, default):
            with contextlib.suppress(AssertionError, SerializationError, TypeError, ValueError):
                setattr(message, name, sample)
                serialize(message)
                break
    return message


def received(sent: Message, cls: Any, policy: str) -> list[Message]:
    """The messages that a subscription with this policy gets."""
    got: list[Message] = []
    receiver = Node("receiver", parameter_overrides=[Parameter("on_type_mismatch", value=policy)])
    sender = Node("sender")
    topic = f"topic{next(_numbers)}"  # each is warned of as often as the first one
    receiver.create_subscription(cls, topic, got.append, 10)
    publisher = sender.create_publisher(type(sent), topic, 10)
    publisher.publish(sent)
    for _ in range(4):
        rclpy.spin_once(receiver, timeout_sec=0)
    receiver.destroy_node()
    sender.destroy_node()
    return got


@pytest.mark.parametrize("policy", ["warn", "refuse"])
def test_each_pair_is_explained_and_refused(
    pairs: list[tuple[Edit, Any, Any]], said: list[str], policy: str
) -> None:
    differing = 0
    for edit, before, after in pairs:
        said.clear()
        begin = time.perf_counter()
        got = received(before(), after, policy)
        if before.__type_hash__ == after.__type_hash__:
            assert (len(got), said) == (1, []), edit
            continue
        differing += 1
        assert time.perf_counter() - begin < 5, "a second, on a machine with nothing else to do"
        if policy == "refuse":
            assert got == [], edit
            assert len(said) == 1, said
        assert f"[{edit.rule}]" in said[0], (edit, said)
    assert differing > len(pairs) / 2


def test_adapters_convert_without_garbage(pairs: list[tuple[Edit, Any, Any]], said: list[str]) -> None:
    changed = 0
    for edit, before, after in pairs:
        if before.__type_hash__ == after.__type_hash__:
            continue
        old, new = before.get_fields_and_field_types(), after.get_fields_and_field_types()
        same = [name for name, kind in old.items() if new.get(name) == kind]

        def upgrade(message: Message, same: list[str] = same, cls: Any = after) -> Message:
            return cls(**{name: getattr(message, name) for name in same})

        register(Adapter(before, after, upgrade))
        sent = filled(before)
        (message,) = received(sent, after, "adapt")
        assert message == upgrade(received(sent, before, "refuse")[0]), edit
        changed += message != after()
    assert changed > len(pairs) / 4
