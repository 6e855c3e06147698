"""With any names of fields and any comments in a definition, the module compiles and the class works."""

from __future__ import annotations

import ast
import copy
import keyword
import sys
import types
from array import array
from collections.abc import Iterator
from math import isinf
from pathlib import Path
from typing import Any
from unittest.mock import patch

import ifgen_runtime
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from ifgen.definition.interfaces import Constant, Field, InterfacePackage, Message, Registry
from ifgen.definition.names import attribute_name
from ifgen.definition.omg_idl import python_names
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from ifgen.diagnostics import Source, Span
from ifgen.generator_py.imports import IN_MESSAGES
from ifgen.generator_py.messages import docstrings
from ifgen.generator_py.messages.package import plan
from ifgen.generator_py.templates.render import Templates
from ifgen.generator_py.tests.package import plan_interface_tests

BASIC = ("boolean", "octet", "char", "int8", "uint8", "int16", "uint32", "int64", "uint64", "float", "double")
# Names that generated code itself uses, Python's own, and ordinary ones.
USED = sorted(
    name
    for name in {
        *IN_MESSAGES,
        *keyword.kwlist,
        *dir(__builtins__),
        *(
            "numpy",
            "self",
            "other",
            "memo",
            "value",
            "copied",
            "message",
            "check_fields",
            "data",
            "view",
            "m",
            "p",
        ),
    }
    if name.islower() and "__" not in name and name[0] != "_" and name[-1] != "_"
)
# Names in .idl files can be any identifier.
idl_names = st.one_of(
    st.sampled_from([*USED, "DEFAULT", "Any", "None", "SLOT_TYPES", "A__DEFAULT", "AEnum", "from_", "a__b"]),
    st.from_regex(r"[A-Ca-c][A-Ca-c0-9_]{0,5}", fullmatch=True),
)
field_names = st.one_of(
    st.sampled_from(USED), st.from_regex(r"[a-z]([a-z0-9]|_[a-z0-9]){0,8}", fullmatch=True), idl_names
)
constant_names = st.one_of(
    st.sampled_from(["DEFAULT", "TYPE_CHECKING", "SLOT", "A"]),
    st.from_regex(r"[A-Z][A-Z0-9]{0,5}", fullmatch=True),
    idl_names,
)
class_names = st.one_of(
    st.sampled_from(
        [
            "Message",
            "MessageMeta",
            "Any",
            "Final",
            "NoSuchField",
            "Sequence",
            "Iterable",
            "DEFAULT",
            "IntEnum",
        ]
    ),
    st.from_regex(r"[A-Z][A-Za-z0-9_]{0,8}", fullmatch=True),
)
comments = st.one_of(
    st.text(max_size=80),
    st.sampled_from(
        ['"', '""" quotes """', "\\", "\\U", "ends with \\", 'ends with "', "\t tab", "é", "a\n\n  b\n"]
    ),
)


def _value(type_: Any) -> st.SearchStrategy[Any]:
    match type_:
        case BasicType("boolean"):
            return st.booleans()
        case BasicType("octet"):
            return st.binary(min_size=1, max_size=1)
        case BasicType("char"):
            return st.characters(max_codepoint=127)
        case BasicType("float" | "double"):
            # Numbers that a float32 cannot hold exactly, and numbers that it cannot hold at all.
            return st.sampled_from([0.1, 36.6, 1e-9, 1e39]) | st.floats(allow_nan=False, allow_infinity=False)
        case BasicType("int8"):
            return st.integers(-128, 127)
        case BasicType():
            return st.integers(0, 127)
        case _:
            # The reader accepts neither NUL nor half a surrogate pair.
            return st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=3)


PLACE = Span(Source(Path("Fuzz.idl"), ""), 0, 0)


def can_be_in_a_class(message: Message) -> bool:
    """Whether its names do not collide; those of .msg files never do."""
    problems = FileProblems(PLACE.source)
    python_names.check(message.fields, message.constants, problems)
    return not problems


@st.composite
def fields(draw: st.DrawFn) -> Field:
    value_type: Any = draw(
        st.one_of(
            st.builds(BasicType, st.sampled_from(BASIC)),
            st.sampled_from([UnboundedString(), UnboundedWString(), BoundedString(3)]),
        )
    )
    form = draw(st.sampled_from(["value", "array", "sequence", "bounded"]))
    type_: Any = {
        "value": value_type,
        "array": Array(value_type, 2),
        "sequence": UnboundedSequence(value_type),
        "bounded": BoundedSequence(value_type, 3),
    }[form]
    values = _value(value_type) if form == "value" else st.tuples(_value(value_type), _value(value_type))
    return Field(
        draw(field_names),
        type_,
        draw(st.none() | values),
        draw(comments),
        draw(st.none() | st.sampled_from(["m/s", '"', "\\"])),
        PLACE,
    )


@st.composite
def constants(draw: st.DrawFn) -> Constant:
    type_: Any = draw(st.one_of(st.builds(BasicType, st.sampled_from(BASIC)), st.just(UnboundedString())))
    return Constant(draw(constant_names), type_, draw(_value(type_)), draw(comments), PLACE)


@st.composite
def messages(draw: st.DrawFn) -> Message:
    message = Message(
        "fuzz_msgs",
        "msg",
        draw(class_names),
        tuple(draw(st.lists(fields(), max_size=6, unique_by=lambda field: field.name))),
        tuple(draw(st.lists(constants(), max_size=3, unique_by=lambda constant: constant.name))),
        draw(comments),
        source=Source(Path("Fuzz.idl"), draw(comments)),
    )
    assume(can_be_in_a_class(message))
    return message


@pytest.fixture(autouse=True)
def no_trace() -> Iterator[None]:
    yield
    for name in [name for name in sys.modules if name.startswith("fuzz_msgs")]:
        del sys.modules[name]


def load(message: Message) -> types.ModuleType:
    """Execute the module of a message and return it."""
    package = InterfacePackage("fuzz_msgs", (message,))
    registry = Registry.of({"fuzz_msgs": package}, ("fuzz_msgs",))
    render = Templates().render
    files = {artifact.path: render(artifact).text for artifact in plan(package, registry)}
    (path,) = [path for path in files if path.startswith("msg/_") and "__init__" not in path]
    for text in files.values():
        ast.parse(text)
    module = types.ModuleType(f"fuzz_msgs.msg.{path[4:-3]}")
    sys.modules[module.__name__] = module
    exec(compile(files[path], path, "exec"), vars(module))
    return module


@settings(max_examples=60)
@given(messages())
def test_the_class_works(message: Message) -> None:
    module = load(message)
    cls = getattr(module, message.name)
    assert module.__source__ == message.source.text  # type: ignore[union-attr]
    assert list(cls.get_fields_and_field_types()) == [field.name for field in message.fields]
    one, two = cls(), cls(check_fields=True)
    assert one == two == copy.deepcopy(one) == cls.__default__()
    assert repr(one) == repr(two)
    for field in message.fields:
        if field.default_value is not None:
            assert holds(getattr(one, attribute_name(field)), field)
    for constant in message.constants:
        assert getattr(cls, constant.name) == constant.value
        with pytest.raises(AttributeError, match=f"property '{constant.name}' of 'Metaclass_{message.name}'"):
            setattr(cls, constant.name, None)
    with pytest.raises(TypeError, match="constructor: no_such_field"):
        cls(no_such_field=1)


def holds(stored: Any, field: Field) -> bool:
    """Whether a field holds its default: a single number is as written, as in rosidl's classes."""
    default = field.default_value
    if isinstance(default, tuple):
        expected = array("f", default) if "float" in repr(field.type) else default  # type: ignore[arg-type]
        return list(stored) == list(expected)
    return stored == default or (field.type == BasicType("float") and isinf(stored) and abs(default) > 3.4e38)


@settings(max_examples=60)
@given(messages())
def test_its_tests_pass(message: Message) -> None:
    package = InterfacePackage("fuzz_msgs", (message,))
    registry = Registry.of({"fuzz_msgs": package}, ("fuzz_msgs",))
    (artifact,) = plan_interface_tests(package, registry)
    module = load(message)
    folder, rclpy = types.ModuleType("fuzz_msgs.msg"), types.ModuleType("rclpy")
    setattr(folder, message.name, getattr(module, message.name))
    vars(rclpy)["serialization"] = types.SimpleNamespace(
        serialize_message=ifgen_runtime.serialize,
        deserialize_message=ifgen_runtime.deserialize,
    )
    found = types.ModuleType("fuzz_msgs.tests")
    found.__file__ = f"/fuzz_msgs/{artifact.path}"
    fuzz_msgs = types.ModuleType("fuzz_msgs")
    vars(fuzz_msgs)["msg"] = folder
    modules = {m.__name__: m for m in (found, folder, fuzz_msgs, rclpy)}
    with patch.dict(sys.modules, modules), patch.object(sys, "path", [*sys.path]):
        exec(compile(Templates().render(artifact).text, artifact.path, "exec"), vars(found))
        (case,) = found.CASES
        for name, test in vars(found).items():
            if name.startswith("test_"):
                test(case)


@given(comments, st.sampled_from([4, 8, 12]))
def test_docstrings_are_string_literals(text: str, indent: int) -> None:
    literal = docstrings.docstring(text or "x", indent=indent)
    assert isinstance(ast.literal_eval(literal), str)
    assert all(line == line.rstrip() for line in literal.split("\n"))


@given(st.text())
def test_source_literals_say_what_the_source_says(text: str) -> None:
    literal = docstrings.source_literal(text)
    assert ast.literal_eval(literal) == text
    assert all(line == line.rstrip() for line in literal.split("\n"))
