"""The text of the codecs: the properties that templates and linters rely on."""

from __future__ import annotations

import ast
import builtins

import ifgen
import pytest
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec import Extents, plan_codec
from ifgen.generator_py.codec.alignment import Alignment, RunItem, run_format
from ifgen.generator_py.codec.text import Body
from ifgen.generator_py.names import class_reference
from ifgen_runtime import codec as runtime

from .support import OWN_INTERFACES, ROOT


@pytest.fixture(scope="module")
def registry() -> Registry:
    return ifgen.load(ROOT / "interfaces", OWN_INTERFACES)


def messages(registry: Registry) -> list[Message]:
    parts = [[i] if isinstance(i, Message) else i.messages for i in registry]
    return [message for group in parts for message in group]


def test_text_is_whole(registry: Registry) -> None:
    """Each codec defines, imports or receives as an argument every name that it uses, and no others."""
    extents = Extents(registry)
    for message in messages(registry):
        codec = plan_codec(message, extents)
        text = "\n".join([*codec.constants, codec.serialize, codec.deserialize, codec.attachment])
        assert max(map(len, text.splitlines())) <= 106, message.type_name
        nodes = list(ast.walk(ast.parse(text)))
        names = [node for node in nodes if isinstance(node, ast.Name)]
        loaded = {node.id for node in names if isinstance(node.ctx, ast.Load)}
        stored = {node.id for node in names if isinstance(node.ctx, ast.Store)}
        home = NamespacedType(message.package, message.folder, message.name)
        given = {class_reference(type_, message) for type_ in (*codec.class_types, home)}
        given |= {node.name for node in nodes if isinstance(node, ast.FunctionDef)}
        given |= {node.arg for node in nodes if isinstance(node, ast.arg)}
        unknown = loaded - stored - given - set(dir(builtins)) - set(codec.runtime_imports)
        assert not unknown, (message.type_name, unknown)
        assert set(codec.runtime_imports) <= loaded & set(runtime.__all__), message.type_name
        constants = {line.split(" ")[0] for line in codec.constants if line.startswith("_")}
        assert constants <= loaded, (message.type_name, constants - loaded)


def test_types_of_one_name_are_kept_apart(registry: Registry) -> None:
    """Parts of one interface are named by their names, classes of other modules by package and folder too."""
    event = plan_codec(registry.message("codec_msgs/srv/Ask_Event"), Extents(registry))
    assert "creator(Ask_Request)" in " ".join(event.constants)
    assert ".__class__ is Ask_Response" in event.serialize
    assert "creator(codec_msgs_msg_Pair)" in " ".join(event.constants)


@pytest.mark.parametrize(("start", "text", "size"), [(0, "B3xI2d", 24), (3, "BI2d", 21), (4, "B3xI4x2d", 28)])
def test_runs_are_laid_out_where_they_are(start: int, text: str, size: int) -> None:
    run = [RunItem("B", 1, 1, "a"), RunItem("I", 4, 4, "b"), RunItem("d", 8, 8, "c"), RunItem("d", 8, 8, "d")]
    assert run_format(run, start) == (text, size)


def test_knowledge_about_positions() -> None:
    known, half = Alignment(8, 5), Alignment(4, 2)
    assert known.advanced(5) == Alignment(8, 2)
    assert known.aligned(4) == Alignment(8, 0) and half.aligned(8) == Alignment(8, 0)
    assert half.aligned(2) == half and not half.is_aligned(4) and half.is_aligned(2)
    assert known.either(Alignment(8, 1)) == Alignment(4, 1)
    assert known.either(Alignment(8, 2)) == Alignment(1, 0)
    assert half.either(known) == Alignment(1, 0) and half.either(Alignment(8, 6)) == half


def test_positions_that_nobody_reads_are_not_kept() -> None:
    body = Body()
    body.place("4")
    body.move("8")
    body.add("x = table[p & 4]")
    body.move("len(x)")
    with body.block("for y in z:"):
        body.add("w = y")
        body.move("3")
    body.place("0")
    assert body.lines(0) == ["p = 4", "p += 8", "x = table[p & 4]", "for y in z:", "    w = y"]
