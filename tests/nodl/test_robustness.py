"""No input causes a traceback or takes long: random bytes and trees, mutated documents, bombs."""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.command_kit import report
from ifgen.nodl import document, endpoints, options, parameters
from ifgen.nodl.validators import RULES
from ifgen.nodl.values import ARRAYS, SCALARS

from .conftest import Loaded, load_from

EXAMPLES = Path(__file__).parent / "examples"
VALID = [path.read_text() for path in sorted(EXAMPLES.iterdir())]
WORDS = [
    *document._KEYS, *endpoints.QOS_KEYS, *parameters.KEYS, *options.Options.model_fields,
    *options.TimerOptions.model_fields, *RULES, *SCALARS, *ARRAYS, "bounds<>", "a::b", "string_fixed_3",
    "ref", "name", "ifgen", "local://x.nodl.yaml", "std_msgs/msg/String", "std_srvs/Trigger", "~/a", "/a", "a.b",
    "KEEP_LAST", "RELIABLE", "asyncio",
]  # fmt: skip


def load_text(data: str | bytes, extension: str = "yaml") -> Loaded:
    """Load a document, and print what is wrong in all three ways."""
    with tempfile.TemporaryDirectory() as folder:
        loaded = load_from(Path(folder), {f"demo/nodl/talker.nodl.{extension}": data})
        report.for_people(loaded.diagnostics)
        report.as_json(loaded.diagnostics)
        report.as_github_annotations(loaded.diagnostics)
    for found in loaded.diagnostics:
        if found.primary is not None:
            span = found.primary.span
            assert 0 <= span.start <= span.end <= len(span.source.text) + 1
    return loaded


scalars = st.one_of(
    st.sampled_from(WORDS),
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=5),
    st.dates(),
)
keys = st.one_of(st.sampled_from(WORDS), st.text(max_size=3), st.integers(0, 3), st.booleans())
trees = st.recursive(
    scalars,
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(keys, inner, max_size=5)),
    max_leaves=30,
)


@settings(max_examples=150)
@given(
    st.one_of(st.binary(max_size=60), st.text(max_size=60).map(lambda text: text.encode("utf-8", "replace")))
)
def test_any_bytes(data: bytes) -> None:
    for extension in ("yaml", "json"):
        assert load_text(data, extension).nodes is None


@settings(max_examples=120)
@given(st.dictionaries(st.sampled_from(WORDS), trees, max_size=6))
def test_any_tree(tree: dict[str, object]) -> None:
    """As YAML, and as JSON if it can be written that way."""
    load_text(yaml.safe_dump({"nodl_version": 2, **tree}, allow_unicode=True))
    load_text(json.dumps({"nodl_version": 2, **tree}, default=str, skipkeys=True), "json")


@settings(max_examples=30)
@given(st.data())
def test_mutated_documents(data: st.DataObject) -> None:
    _load_mutated_text(data)


@pytest.mark.slow
@settings(max_examples=150)
@given(st.data())
def test_many_mutated_documents(data: st.DataObject) -> None:
    _load_mutated_text(data)


def _load_mutated_text(data: st.DataObject) -> None:
    """Pieces of documents left out, doubled, moved and replaced by others."""
    text = data.draw(st.sampled_from(VALID))
    for _ in range(data.draw(st.integers(1, 3))):
        cut = sorted(data.draw(st.tuples(*[st.integers(0, len(text))] * 2)))
        piece = st.sampled_from(
            [
                "",
                "\n",
                "  ",
                "- ",
                "\\0",
                "\\U00110000",
                "1:" * 200 + "1.",
                ": ",
                "{",
                "]",
                "'",
                '"',
                "&a ",
                "*a",
                "!!x ",
                "|",
                "\t",
                "\ufeff",
            ]
        )
        new = data.draw(st.one_of(piece, st.sampled_from(WORDS), st.just(text[cut[0] : cut[1]] * 2)))
        end = cut[1] if data.draw(st.booleans()) else min(cut[0] + 3, len(text))
        text = text[: cut[0]] + new + text[end:]
    load_text(text)


places = st.lists(st.integers(0, 60), min_size=1, max_size=3)


@settings(max_examples=20)
@given(st.sampled_from(VALID), places, trees)
def test_mutated_trees(text: str, where: list[int], tree: object) -> None:
    _load_mutated_tree(text, where, tree)


@pytest.mark.slow
@settings(max_examples=100)
@given(st.sampled_from(VALID), places, trees)
def test_many_mutated_trees(text: str, where: list[int], tree: object) -> None:
    _load_mutated_tree(text, where, tree)


def _load_mutated_tree(text: str, where: list[int], tree: object) -> None:
    """A value somewhere in a valid document is replaced by another one."""
    root = yaml.safe_load(text)
    node = root
    for number in where[:-1]:
        children = list(node.values()) if isinstance(node, dict) else node
        if not isinstance(children, list) or not children:
            break
        child = children[number % len(children)]
        if not isinstance(child, dict | list):
            break
        node = child
    if isinstance(node, dict) and node:
        node[list(node)[where[-1] % len(node)]] = tree
    elif isinstance(node, list) and node:
        node[where[-1] % len(node)] = tree
    load_text(yaml.safe_dump(root, allow_unicode=True, sort_keys=False))


LAUGHS = (
    "nodl_version: 2\ncodegen:\n  x:\n    a0: &a0 [lol, lol, lol, lol, lol, lol, lol, lol, lol]\n"
    + "".join(f"    a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12))
)
ENDPOINT = "{name: a, type: std_msgs/String, qos: {history: KEEP_ALL, reliability: RELIABLE}}"
BOMBS = {
    "billion laughs": LAUGHS,
    "aliased lists": f"publishers: &p [{', '.join([ENDPOINT] * 90)}]\ncodegen: {{x: {{y: [{'*p, ' * 900}]}}}}\n",
    "merge keys": "codegen:\n  x: &x {a: 1}\n"
    + "".join(f"  y{i}: &y{i} {{<<: [{', '.join(['*x'] * 99)}], b{i}: *x}}\n" for i in range(999)),
    "deep lists": "[" * 20_000,
    "deep maps": "{a: " * 20_000,
    "deep blocks": "".join(" " * i + "a:\n" for i in range(700)),
    "dashes": "- " * 100_000,
    "questions": "? " * 20_000,
    "long": "nodl_version: 2\ndescription: " + "long " * 100_000,
    "many keys": "nodl_version: 2\n" + "".join(f"k{i}: 1\n" for i in range(20_000)),
    "same key": "nodl_version: 2\n" + "a: 1\n" * 20_000,
    "many endpoints": "nodl_version: 2\npublishers:\n" + f"  - {ENDPOINT}\n" * 3_000,
    "quotes": "nodl_version: 2\ndescription: '" + "'' " * 60_000,
    "anchors": "nodl_version: 2\ncodegen: {x: [" + "".join(f"&a{i} 1, " for i in range(20_000)) + "*b]}\n",
    "sexagesimal": "nodl_version: 2\nparameters: {a: {type: int, default_value: " + "1:" * 140_000 + "1}}\n",
    "no spaces": "nodl_version: 2\npublishers: [{name: " + "a/" * 60_000 + "}]\n",
}


LONG_ONES = {"anchors", "many keys", "same key"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in LONG_ONES else []) for name in BOMBS]
)
def test_bombs_end_quickly(name: str) -> None:
    """Each is refused within seconds, with a report that fits on a screen or two."""
    started = time.process_time()
    loaded = load_text(BOMBS[name])
    assert time.process_time() - started < 8
    assert loaded.nodes is None
    assert 1 <= len(loaded.diagnostics) <= 25
    if name in {"billion laughs", "merge keys", "deep lists", "deep maps", "deep blocks", "dashes", "long"}:
        assert loaded.rules == ["too-large"]


@pytest.mark.parametrize(
    "text", ["[" * 20_000, '{"a":' * 20_000, '{"nodl_version":' + "[1," * 30, "1" * 10_000]
)
def test_json_bombs_end_quickly(text: str) -> None:
    assert load_text(text, "json").nodes is None


def test_a_folder_in_place_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "demo/nodl/talker.nodl.yaml").mkdir(parents=True)
    loaded = load_from(
        tmp_path, {"demo/nodl/a.nodl.yaml": "nodl_version: 2\ninclude: [{ref: local://../nodl}]"}
    )
    assert loaded.rules == ["unreadable-path", "unknown-include"]


LONG = "a" * 100_000
ODD = {
    "a long name": f"publishers: [{{name: {LONG}, type: std_msgs/String, qos: {{history: KEEP_ALL, reliability: RELIABLE}}}}]",
    "a long package": f"service_clients: [{{name: a, type: {LONG}/String}}]",
    "a long type": f"service_clients: [{{name: a, type: std_srvs/A{LONG}}}]",
    "a long parameter": f"parameters: {{{'a.' * 100}a: {{type: int}}, {'a.' * 50_000}: {{type: int}}}}",
    "a long include": f"include: [{{ref: 'local://{LONG}'}}, {{ref: 'nodl://{LONG}/a'}}, {{ref: 'nodl://a/{LONG}'}}]",
    "a null character": 'include: [{ref: "local://a\\0b"}, {ref: "nodl://a\\0b/c"}, {ref: "nodl://demo/a\\0b"}]',
    "a folder above": "include: [{ref: 'nodl://../demo'}, {ref: 'local://..'}, {ref: 'local://.'}]",
    "a ring of links": "include: [{ref: local://ring.nodl.yaml}]",
    "many topics": "".join(
        f"{category}: [" + ", ".join(f"{{name: a{i}, type: std_msgs/String, qos: *q}}" for i in range(3000)) + "]\n"
        for category in ("publishers", "subscriptions")
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ODD)
def test_odd_names(tmp_path: Path, name: str) -> None:
    """Names that no file can have, and so many names that comparing all pairs would take long."""
    anchor = "codegen: {x: {y: &q {history: KEEP_ALL, reliability: RELIABLE}}}\n"
    (tmp_path / "demo/nodl").mkdir(parents=True)
    (tmp_path / "demo/nodl/ring.nodl.yaml").symlink_to("ring.nodl.yaml")
    started = time.process_time()
    loaded = load_from(tmp_path, {"demo/nodl/talker.nodl.yaml": f"nodl_version: 2\n{anchor}{ODD[name]}\n"})
    assert time.process_time() - started < 8
    assert loaded.nodes is None
    shown = report.for_people(loaded.diagnostics)
    assert len(shown.plain) < 3000
