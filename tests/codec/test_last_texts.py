"""The codec in C keeps the strings that a sequence had last: nobody gets those of another message."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("ifgen_native._native", reason="ifgen_native is not built: `make` does it")

from ifgen_runtime import (  # as above
    DeserializationError,
    SerializationError,
    deserialize,
    serialize,
)
from ifgen_runtime.codec.choice import chosen  # as above

from .support import generate  # as above

pytestmark = pytest.mark.skipif(chosen().extension is None, reason="the codec in C does not run here")

ARM = ["shoulder", "elbow", "é", ""]
LEG = ["hip", "knee", "ankle", "toe"]


@pytest.fixture(scope="module")
def joints(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("joints")
    messages = folder / "in" / "joint_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Joints.msg").write_text("string[] name\nfloat64[] position\n")
    return generate(Path(folder / "out"), folder / "in")["joint_msgs/msg/Joints"]


def read(joints: Any, names: list[str], position: float = 0.1) -> Any:
    return deserialize(serialize(joints(name=names, position=[position])), joints)


def test_each_message_has_a_list_of_its_own(joints: Any) -> None:
    first, second = read(joints, ARM), read(joints, ARM)
    first.name.append("hand")
    first.name[0] = "wrist"
    assert second.name == ARM
    assert read(joints, ARM).name == ARM


def test_other_strings_and_other_numbers_of_them(joints: Any) -> None:
    for round_ in range(20):
        for names in (ARM, LEG, LEG[:3], [], ARM, ARM, ["x" * 5000], [f"joint_{round_}"], LEG):
            message = read(joints, names, 0.1 * round_)
            assert (message.name, list(message.position)) == (names, [0.1 * round_])


def test_strings_that_are_cut_are_refused(joints: Any) -> None:
    whole = serialize(joints(name=LEG))
    assert deserialize(whole, joints).name == LEG
    end = whole.index(b"toe")
    for size in range(end - 30, end + 4):
        with pytest.raises(DeserializationError):
            deserialize(whole[:size], joints)
    changed = whole.replace(b"toe", b"tip")
    assert deserialize(changed, joints).name == [*LEG[:3], "tip"]


def test_the_same_strings_are_not_made_again(joints: Any) -> None:
    """That is what all this is for."""
    for _ in range(9):  # one in eight others is kept
        read(joints, ARM)
        read(joints, ["a", "long", "name", f"{_}"])
    messages = [read(joints, ["the", "same", "names"]) for _ in range(10)]
    assert messages[-1].name[0] is messages[-2].name[0]


def test_strings_are_written_as_they_are_now(joints: Any) -> None:
    names = list(ARM)
    message = joints(name=names)
    for _ in range(3):
        assert deserialize(serialize(message), joints).name == ARM
    names[1] = "hand"
    assert deserialize(serialize(message), joints).name == ["shoulder", "hand", "é", ""]
    names[1] = 5
    with pytest.raises(SerializationError, match=r"Joints.name\[1\]: expected str, got int"):
        serialize(message)
    names[:] = ARM
    for end in range(5):
        names[end:] = []
        assert deserialize(serialize(message), joints).name == ARM[:end]
        names[:] = ARM


def test_alike_strings_that_are_other_objects(joints: Any) -> None:
    for round_ in range(20):
        names = [f"joint_{index}" for index in range(round_)]
        assert deserialize(serialize(joints(name=names)), joints).name == names
        assert serialize(joints(name=names)) == serialize(joints(name=[*names]))
