"""The text of the codecs: the properties that templates and linters rely on."""

from __future__ import annotations

import ast
import builtins

import ifgen
import pytest
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.text import render
from ifgen.generator_py.names import class_reference, slot_name
from ifgen.wire.plan import Extents, plan
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
        codec = render(plan(message, extents, slot_name))
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
    event = render(plan(registry.message("codec_msgs/srv/Ask_Event"), Extents(registry), slot_name))
    assert "creator(Ask_Request)" in " ".join(event.constants)
    assert ".__class__ is Ask_Response" in event.serialize
    assert "creator(codec_msgs_msg_Pair)" in " ".join(event.constants)
