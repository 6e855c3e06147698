"""For any template the check ends with a list of problems; jinja2 parses every template that it passes."""

from __future__ import annotations

import jinja2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.config.customization import Customization
from ifgen.definition.interfaces import Constant, Field, InterfacePackage, Message, Registry
from ifgen.definition.types import BasicType, UnboundedString
from ifgen.generator_py.messages.package import plan
from ifgen.generator_py.outputs.interfaces import interface_model
from ifgen.generator_py.templates.check.syntax import _OffsetLexer
from ifgen.generator_py.templates.render import _environment_for

from .conftest import check_text

INTERFACE = Message(
    "p_msgs",
    "msg",
    "Point",
    (Field("x", BasicType("double")), Field("y", UnboundedString())),
    (Constant("A", BasicType("uint8"), 1),),
)
REGISTRY = Registry.of({"p_msgs": InterfacePackage("p_msgs", (INTERFACE,))}, ("p_msgs",))
GIVEN = {
    **plan(REGISTRY.packages["p_msgs"], REGISTRY)[-1].variables,
    "interface": interface_model(INTERFACE, REGISTRY),
}

NAMES = st.sampled_from(
    ["module", "interface", "messages", "x", "loop", "super", "self", "caller", "action", "name"]
)
ATOMS = st.one_of(
    NAMES, st.sampled_from(["1", "-2.5", "'a'", "none", "true", "[]", "{}", "()", "['a', 1]", "{'a': x}"])
)


def _more(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    words = st.sampled_from(
        [
            "upper",
            "map",
            "join",
            "first",
            "list",
            "groupby",
            "default",
            "nope",
            "sort",
            "batch",
            "length",
            "indent",
            "attr",
        ]
    )
    tests = st.sampled_from(["none", "string", "divisibleby", "nope", "sameas", "in"])
    return st.one_of(
        st.builds("{}.{}".format, inner, NAMES),
        st.builds("{}[{}]".format, inner, inner),
        st.builds("{}[1:{}]".format, inner, inner),
        st.builds("{}|{}".format, inner, words),
        st.builds("{}|{}({}, attribute={})".format, inner, words, inner, inner),
        st.builds("{}({}, a={})".format, inner, inner, inner),
        st.builds("{}(*{}, **{})".format, inner, inner, inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds(
            "({} {} {})".format,
            inner,
            st.sampled_from(["and", "or", "+", "~", "==", "in", "not in", "//", "**"]),
            inner,
        ),
        st.builds("(not {})".format, inner),
        st.builds("({} is {} {})".format, inner, tests, inner),
        st.builds("({}, {})".format, inner, inner),
    )


EXPRESSIONS = st.recursive(ATOMS, _more, max_leaves=6)


def _statements(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    e, n = EXPRESSIONS, NAMES
    return st.one_of(
        st.builds("{}{}".format, inner, inner),
        st.builds(
            "{{% if {} %}}{}{{% elif {} %}}{}{{% else %}}{}{{% endif %}}".format, e, inner, e, inner, inner
        ),
        st.builds("{{% for {} in {} %}}{}{{% else %}}{}{{% endfor %}}".format, n, e, inner, inner),
        st.builds("{{% for {}, y in {} if {} recursive %}}{}{{% endfor %}}".format, n, e, e, inner),
        st.builds("{{% set {} = {} %}}{}".format, n, e, inner),
        st.builds("{{% set {} | upper %}}{}{{% endset %}}".format, n, inner),
        st.builds("{{% with {} = {} %}}{}{{% endwith %}}".format, n, e, inner),
        st.builds("{{% macro {}({}, z={}) %}}{}{{% endmacro %}}".format, n, n, e, inner),
        st.builds("{{% call({}) {} %}}{}{{% endcall %}}".format, n, st.builds("{}({})".format, n, e), inner),
        st.builds("{{% filter upper %}}{}{{% endfilter %}}".format, inner),
        st.builds(
            "{{% block {} {}%}}{}{{% endblock %}}".format,
            n,
            st.sampled_from(["", "scoped ", "required "]),
            inner,
        ),
        st.builds(
            "{{% include {} {}%}}".format,
            st.one_of(e, st.just("'t.j2'"), st.just("'u.j2'")),
            st.sampled_from(["", "without context ", "ignore missing "]),
        ),
        st.builds("{{% import {} as {} %}}{}".format, st.one_of(e, st.just("'u.j2'")), n, inner),
        st.builds(
            "{{% from 'u.j2' import {} as {}, x {}%}}{}".format,
            n,
            n,
            st.sampled_from(["", "with context "]),
            inner,
        ),
        st.builds("{{% extends {} %}}{}".format, st.one_of(e, st.just("'u.j2'"), st.just("'t.j2'")), inner),
        st.builds("{{% autoescape {} %}}{}{{% endautoescape %}}".format, e, inner),
        st.builds("{{%- raw -%}}{}{{%- endraw -%}}".format, inner),
    )


TEMPLATES = st.recursive(
    st.one_of(
        st.builds("{{{{ {} }}}}".format, EXPRESSIONS),
        st.sampled_from(["text", "\n  ", "{# note #}", "é\r\n"]),
    ),
    _statements,
    max_leaves=8,
)


@settings(max_examples=80)
@given(TEMPLATES, TEMPLATES)
def test_templates_of_any_form(text: str, other: str) -> None:
    _agree_with_jinja(text, other)


@pytest.mark.slow
@settings(max_examples=300)
@given(TEMPLATES, TEMPLATES)
def test_many_templates_of_any_form(text: str, other: str) -> None:
    _agree_with_jinja(text, other)


def _agree_with_jinja(text: str, other: str) -> None:
    found = check_text(text, {"u.j2": other})
    if not found.errors:
        _environment_for(Customization()).parse(text)


ATTRIBUTES = [
    *("messages", "action", "name", "fields", "title", "python"),
    *("kind", "type", "text", "x", "upper", "items"),
]
FILTERS = [
    *("list", "first", "last", "length", "string", "upper", "snake", "tojson", "min", "abs"),
    *("dictsort", "wordcount", "trim", "title", "int", "float", "e"),
    *("join", "indent(2)", "replace('a', 'b')", "center(9)", "slice(2)|list", "batch(2)|list"),
    *("reverse|list", "unique|list", "select|list", "items|list", "map('upper')|list"),
    *("map(attribute='name')|list", "groupby('name')", "sort(attribute='name')", "selectattr('name')|list"),
    *("sum(attribute='name', start='')", "max(attribute='name')", "attr('name')"),
]


def _sensible(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Expressions that jinja2 evaluates as a whole, without empty loops, and that may well work."""
    return st.one_of(
        st.builds("({}).{}".format, inner, st.sampled_from(ATTRIBUTES)),
        st.builds("({})[{}]".format, inner, st.sampled_from(["0", "-1", "'name'", ":9", "x"])),
        st.builds("({})|{}".format, inner, st.sampled_from(FILTERS)),
        st.builds("({})()".format, inner),
        st.builds("({} {} {})".format, inner, st.sampled_from(["+", "~", "==", "in", "%"]), inner),
        st.builds("({}, {})".format, inner, inner),
        st.builds("[{}]".format, inner),
        st.builds("{{'a': {}}}".format, inner),
        st.builds(
            "(({}) is {})".format,
            inner,
            st.sampled_from(["string", "none", "sequence", "mapping", "even"]),
        ),
    )


class _Refused(jinja2.StrictUndefined):
    """An undefined value that fails where it appears, not only where it is used."""

    def __init__(self, *arguments: object) -> None:
        raise jinja2.UndefinedError


STARTS = st.sampled_from(
    [
        "module",
        "interface",
        "module.messages",
        "module.messages[0]",
        "interface.messages[0].fields",
        "'a'",
        "3",
    ]
)


@settings(max_examples=300)
@given(st.recursive(STARTS, _sensible, max_leaves=5), st.booleans())
def test_what_works_is_never_refused(expression: str, loop: bool) -> None:
    text = f"{{% for x in {expression} %}}{{{{ x }}}}{{% endfor %}}" if loop else f"{{{{ {expression} }}}}"
    environment = _environment_for(Customization()).overlay(undefined=_Refused)
    try:
        environment.from_string(text).render(GIVEN)
    except Exception:
        return
    # A filter for text accepts anything that Python prints, and one for lists accepts false values as an empty list.
    found = [line for line in check_text(text).errors if not line.startswith("wrong-type")]
    assert [line for line in found if "true or false has no elements" not in line] == []


@settings(max_examples=300)
@given(st.text(st.sampled_from("{}%#-+ \n\r\t'\"ab.|()[]1=,é"), max_size=40))
def test_any_text(text: str) -> None:
    found = check_text(text)
    if not found.errors:
        _environment_for(Customization()).parse(text)


@settings(max_examples=300)
@given(st.one_of(TEMPLATES, st.text(st.sampled_from("{}%#-+ \n\t'ab.|"), max_size=40)))
def test_tokens_know_where_they_stand(text: str) -> None:
    source = text.replace("\r\n", "\n").replace("\r", "\n")
    lexer = _OffsetLexer(jinja2.Environment(keep_trailing_newline=True))
    end = 0
    try:
        for offset, _, value in lexer.tokeniter(source, None):
            assert source.startswith(value, offset)
            assert not source[end:offset].strip()
            end = offset + len(value)
    except jinja2.TemplateSyntaxError:
        return
    assert not source[end:].strip()
