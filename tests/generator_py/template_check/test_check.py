"""The static check of templates: mistakes are found at their places, and correct code is not reported."""

from __future__ import annotations

import pytest
from ifgen.config.customization import Customization
from ifgen.generator_py.templates.render import look_for_problems

from .conftest import Check


def test_ours_have_no_mistakes() -> None:
    assert look_for_problems(Customization()) == []


WRONG = {
    # names and attributes
    "{{ moduel.title }}": "unknown-name 1:4 'moduel' is not defined here",
    "{{ module.titel }}": "unknown-attribute 1:11 an InterfaceModule has no 'titel'",
    "{{ module['titel'] }}": "unknown-attribute 1:12 an InterfaceModule has no 'titel'",
    "\n  {{- module\n.titel }}": "unknown-attribute 3:2 an InterfaceModule has no 'titel'",
    "{# é\n #}{{ 'ü' ~ module.titel }}": "unknown-attribute 2:20 an InterfaceModule has no 'titel'",
    "{% raw %}{{ x }}{% endraw %}\r\n{{ modul }}": "unknown-name 2:4 'modul' is not defined here",
    "{{ module.title.uppr() }}": "unknown-attribute 1:17 text has no 'uppr'",
    "{{ module.messages[0].nam }}": "unknown-attribute 1:23 a MessageClass has no 'nam'",
    "{{ (module.messages|first).nam }}": "unknown-attribute 1:28 a MessageClass has no 'nam'",
    "{% set x = module.messages %}{{ x[0].nam }}": "unknown-attribute 1:38 a MessageClass has no 'nam'",
    "{% with x = module %}{{ x.nam }}{% endwith %}": "unknown-attribute 1:27 an InterfaceModule has no 'nam'",
    "{% with x = 1 %}{% endwith %}{{ x }}": "unknown-name 1:33 'x' is not defined here",
    "{% if module.action %}{{ module.action.nme }}{% endif %}": "unknown-attribute 1:40 an ActionClass has no 'nme'",
    "{{ module.action.nme if module.action }}": "unknown-attribute 1:18 an ActionClass has no 'nme'",
    "{{ module.action and module.action.nme }}": "unknown-attribute 1:36 an ActionClass has no 'nme'",
    "{{ {'a': module}.b.nme }}": "unknown-attribute 1:20 an InterfaceModule has no 'nme'",
    # loops
    "{% for m in module.messages %}{{ m.nam }}{% endfor %}": "unknown-attribute 1:36 a MessageClass has no 'nam'",
    "{% for m in module.messages %}{% endfor %}{{ m }}": "unknown-name 1:46 'm' is not defined here",
    "{% for m in module.messages if m.nam %}{% endfor %}": "unknown-attribute 1:34 a MessageClass has no 'nam'",
    "{% for x in module.action %}{% endfor %}": "not-iterable 1:19 an ActionClass or nothing has no elements to loop over",
    "{% for x in 3 %}{% endfor %}": "not-iterable 1:13 an integer has no elements to loop over",
    "{% for x in module.messages %}{{ loop.indx }}{% endfor %}": "unknown-attribute 1:39 `loop` has no 'indx'",
    "{% for a, b, c in module.messages[0].renamed %}{% endfor %}": "wrong-type 1:12 3 names for 2 values",
    "{% for k, v in {'a': module}.items() %}{{ v.nam }}{% endfor %}": "unknown-attribute 1:45 an InterfaceModule has no 'nam'",
    # filters, tests and calls
    "{{ module.title|uper }}": "unknown-filter 1:17 there is no filter 'uper'",
    "{{ module.messages|upper }}": "wrong-type 1:20 filter 'upper' is for text, and this is a tuple of MessageClass",
    "{{ module.title|indent(1, 2, 3, 4) }}": "wrong-arguments 1:17 filter 'indent' does not take this: too many positional arguments",
    "{{ module.title|indent(wide=2) }}": "wrong-arguments 1:17 filter 'indent' does not take this: got an unexpected keyword argument 'wide'",
    "{{ module.messages|map(attribute='nam')|join }}": "unknown-attribute 1:35 a MessageClass has no 'nam'",
    "{{ module.messages|map(attribute='codec.nam')|join }}": "unknown-attribute 1:41 a CodecText has no 'nam'",
    "{{ module.messages|map('nam')|join }}": "unknown-filter 1:25 there is no filter 'nam'",
    "{{ (module.messages|sort(attribute='nam')|first).name }}": "unknown-attribute 1:37 a MessageClass has no 'nam'",
    "{{ (module.messages|selectattr('nam')|first).name }}": "unknown-attribute 1:33 a MessageClass has no 'nam'",
    "{{ module.action|length }}": "not-iterable 1:18 an ActionClass or nothing has no elements to loop over",
    "{% if module is defind %}{% endif %}": "unknown-test 1:17 there is no test 'defind'",
    "{{ 3 is divisibleby(2, 3) }}": "wrong-arguments 1:9 test 'divisibleby' does not take this: too many positional arguments",
    "{{ module.title() }}": "not-callable 1:16 text cannot be called",
    "{{ module.messages[0]() }}": "not-callable 1:22 a MessageClass cannot be called",
    "{% filter uper %}x{% endfilter %}": "unknown-filter 1:11 there is no filter 'uper'",
    # macros
    "{% macro m(a) %}{{ a.nme }}{% endmacro %}{{ m(module) }}": "unknown-attribute 1:22 an InterfaceModule has no 'nme'",
    "{% macro m(a) %}{{ b }}{% endmacro %}": "unknown-name 1:20 'b' is not defined here",
    "{% macro m(a) %}{% endmacro %}{{ m(1, 2) }}": "wrong-arguments 1:34 macro 'm' takes 1 argument, not 2",
    "{% macro m(a) %}{% endmacro %}{{ m(b=2) }}": "wrong-arguments 1:36 macro 'm' has no argument 'b'",
    "{% call nobody() %}{% endcall %}": "unknown-name 1:9 'nobody' is not defined here",
    "{{ m(module) }}{% macro m(a) %}{{ a.nme }}{% endmacro %}": "unknown-attribute 1:37 an InterfaceModule has no 'nme'",
    # templates and blocks
    "{% include 'x.j2' %}": "unknown-template 1:13 there is no template 'x.j2'",
    "{% include 't.j2' %}": "template-cycle 1:4 't.j2' includes itself without end",
    "{% extends 't.j2' %}": "template-cycle 1:4 't.j2' extends itself",
    "{% block a %}{{ super() }}{% endblock %}": "unknown-block 1:17 super() finds no block",
    "{% block a %}{% set x = 1 %}{% endblock %}{{ x }}": "unknown-name 1:46 'x' is not defined here",
    # syntax
    "{{ module": "template-syntax 1:4 jinja2 cannot parse this template: unexpected end of template, expected 'end of print statement'",
    "x\n{% for %}": "template-syntax 2:8 jinja2 cannot parse this template: expected an expression, got 'end of statement block'",
    "a\n{{ $ }}": "template-syntax 2:1 jinja2 cannot parse this template: unexpected char '$' at 5",
    "a\n{% for x in module.messages %}\n{% if x %}\n{% endif %}\nb\n": "template-syntax 2:4 jinja2 cannot parse this template: this `for` has no end",
    "{% block a %}{% macro m() %}{% endmacro %}": "template-syntax 1:4 jinja2 cannot parse this template: this `block` has no end",
    "{% for x in y %}\n{% if x %}\n{% endfor %}": "template-syntax 3:4 jinja2 cannot parse this template: found this first",
    "{% nonsense %}": "template-syntax 1:4 jinja2 cannot parse this template: encountered unknown tag 'nonsense'",
}


@pytest.mark.parametrize("text", WRONG)
def test_mistakes(check: Check, text: str) -> None:
    assert check(text).errors == [WRONG[text]]


def test_where_what_has_no_end_begins(check: Check) -> None:
    [problem] = check("{% for x in y %}\n{% if x %}\n{% endfor %}").diagnostics
    [opening] = problem.secondary
    assert (opening.span.line, opening.span.column, opening.text) == (2, 4, "this `if` has no end")
    assert problem.help == "write {% endif %} where it ends"


RIGHT = (
    "{{ foo|default('x') }}{{ module.nope|d(1) }}",
    "{% if bar is defined %}{{ bar }}{% endif %}{% if module.nope is defined %}{{ module.nope.x }}{% endif %}",
    "{% if bar is not defined or bar.x %}{% endif %}{% if bar is undefined %}{% else %}{{ bar }}{% endif %}",
    "{% set n = namespace(a=1) %}{% set n.a = 2 %}{{ n.a }}",
    "{% for x in range(3) %}{{ loop.index }} {{ loop.cycle('a', 'b') }} {{ loop.changed(x) }}{% else %}{% endfor %}",
    "{% for i in module.messages recursive %}{{ loop(module.messages) }}{% endfor %}",
    "{% macro a() %}{{ b() }}{% endmacro %}{% macro b() %}{{ varargs }}{{ kwargs }}{% endmacro %}{{ a() }}",
    "{% macro a(x, y=1) %}{{ caller(x) }}{% endmacro %}{% call(z) a(1) %}{{ z.anything }}{% endcall %}",
    "{% if module.action %}{% set x = 1 %}{% else %}{% set x = 'a' %}{% endif %}{{ x }}",
    "{% if module.action is none %}{% else %}{{ module.action.name }}{% endif %}",
    "{% if not module.action %}{% elif module.action.name %}{{ module.action.name }}{% endif %}",
    "{% if module.action != none and module.action.name %}{{ module.action.name }}{% endif %}",
    "{{ module.action.name if module.action else '' }}",
    "{% for n, v in module.messages[0].renamed %}{{ n.upper() }}{{ v[:2] }}{{ v[0] }}{% endfor %}",
    "{{ module.messages|map(attribute='name')|join(', ') }}{{ module.messages|groupby('name')|length }}",
    "{% for g in module.messages|groupby('name') %}{{ g.grouper }}{{ g.list[0].name }}{% endfor %}",
    "{{ module.messages|batch(2)|list|length }}{{ module.messages|sum(attribute='name') }}{{ module|attr('title') }}",
    "{{ 'a'|replace('a', 'b')|indent(2, first=true) }}{{ 'PointCloud2'|snake }}{{ dict(a=1)|dictsort|length }}",
    "{% set a, b = 1, 2 %}{{ a + b }}{% set c %}text{% endset %}{{ c|upper }}",
    "{% include 'none.j2' ignore missing %}{% include ['none.j2', 'part.j2'] %}{% include module.title %}",
    "{% block a %}{{ self.b() }}{% endblock %}{% block b %}{% endblock %}",
    "{% for m in module.messages %}{% block m scoped %}{{ m.name }}{% endblock %}{% endfor %}",
    "{% import 'macros.j2' as macros %}{{ macros.show(module) }}{% from 'macros.j2' import show as s %}{{ s(1) }}",
    "{{ module.title.split(',')[0].strip().startswith('a') }}{{ interface.kind == 'message' and interface.uses }}",
    "{% autoescape true %}{{ module.title }}{% endautoescape %}{{ lipsum(1) }}{% set j = joiner(',') %}{{ j() }}",
    "{{ [1, module.title, none] }}{{ (1, 2)[0] }}{{ not x is defined }}{{ -1 + 2 * 3 // 4 ~ 'a' }}{{ 1 in [1] }}",
)


@pytest.mark.parametrize("text", RIGHT)
def test_what_works_is_left_alone(check: Check, text: str) -> None:
    others = {"part.j2": "{{ module.title }}", "macros.j2": "{% macro show(x) %}{{ x }}{% endmacro %}"}
    assert check(text, others).errors == []


def test_what_may_be_nothing_is_a_warning(check: Check) -> None:
    [problem] = check("{{ module.action.name }}").diagnostics
    assert problem.severity == "warning"
    assert problem.message == "this may be none, which has no 'name'"
    assert problem.help == "put it into an `{% if module.action %}`"
    [printed] = check("{{ module.messages }}").diagnostics
    assert (printed.severity, printed.rule) == ("warning", "printed-value")


def test_includes_know_the_names_around_them(check: Check) -> None:
    text = "{% for message in module.messages %}{% include 'part.j2' %}{% endfor %}"
    assert check(text, {"part.j2": "{{ message.name }}"}).lines == []
    assert check(text, {"part.j2": "\n{{ message.nam }}"}).lines == [
        "unknown-attribute 2:12 a MessageClass has no 'nam'"
    ]
    without = text.replace("'part.j2'", "'part.j2' without context")
    assert check(without, {"part.j2": "{{ message }}"}).lines == [
        "unknown-name 1:4 'message' is not defined here"
    ]


def test_blocks_know_their_templates_names_alone(check: Check) -> None:
    base = "{% set here = module %}{% for m in module.messages %}{% block b %}{% endblock %}{% endfor %}"
    child = "{% extends 'base.j2' %}{% set more = 1 %}{% block b %}{{ here.title }}{{ more }}{{ m }}{% endblock %}"
    assert check(child, {"base.j2": base}).lines == ["unknown-name 1:84 'm' is not defined here"]
    scoped = base.replace("block b", "block b scoped")
    assert check(child, {"base.j2": scoped}).errors == []


def test_blocks_that_nothing_renders(check: Check) -> None:
    base = "{% block header %}{% block inner %}{% endblock %}{% endblock %}"
    child = "{% extends 'base.j2' %}{% block inner %}{% endblock %}{% block heder %}{% endblock %}"
    [problem] = check(child, {"base.j2": base}).diagnostics
    assert problem.message == "this overrides nothing: there is no block 'heder'"
    assert problem.help == "did you mean 'header'?"
    nested = "{% extends 'base.j2' %}{% block header %}{% block new %}{% endblock %}{% endblock %}"
    assert check(nested, {"base.j2": base}).lines == []


def test_super_is_followed(check: Check) -> None:
    base = "{% block a %}{{ module.nope }}{% endblock %}"
    child = "{% extends 'base.j2' %}{% block a %}{{ super() }}{% endblock %}"
    [problem] = check(child, {"base.j2": base}).diagnostics
    assert problem.primary is not None
    assert problem.primary.span.source.path.name == "base.j2"
    assert check(child.replace("{{ super() }}", ""), {"base.j2": base}).lines == []


def test_imports_see_no_names_and_have_those_that_they_set(check: Check) -> None:
    assert check("{% import 'm.j2' as m %}{{ m.x }}{{ m.y }}", {"m.j2": "{% set x = 1 %}"}).lines == [
        "unknown-attribute 1:39 `m.j2` has no 'y'"
    ]
    assert check("{% from 'm.j2' import y %}", {"m.j2": "{% set x = 1 %}"}).lines == [
        "unknown-name 1:23 'm.j2' has no 'y'"
    ]
    assert check("{% import 'm.j2' as m %}", {"m.j2": "{% set x = module %}"}).lines == [
        "unknown-name 1:12 'module' is not defined here"
    ]
    assert check("{% import 'm.j2' as m with context %}", {"m.j2": "{% set x = module %}"}).lines == []


@pytest.mark.parametrize(
    ("others", "errors"),
    [
        ({"a.j2": "{% extends 't.j2' %}"}, 1),
        ({"a.j2": "{% include 't.j2' %}"}, 1),
        ({"a.j2": "{% if module.action %}{% include 't.j2' %}{% endif %}"}, 0),
        ({"a.j2": "{% import 't.j2' as t %}"}, 0),
    ],
)
def test_cycles(check: Check, others: dict[str, str], errors: int) -> None:
    found = check("{% extends 'a.j2' %}" if "extends" in others["a.j2"] else "{% include 'a.j2' %}", others)
    assert [line.split()[0] for line in found.errors] == ["template-cycle"] * errors


def test_every_problem_once(check: Check) -> None:
    text = "{% macro m(a) %}{{ a.nope }}{% endmacro %}{{ m(module) }}{{ m(module) }}{% include 'p.j2' %}{% include 'p.j2' %}"
    assert len(check(text, {"p.j2": "{{ nope }}"}).lines) == 2
