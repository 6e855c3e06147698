"""The JSON schema of NoDL refuses what the reader refuses for its shape, and nothing that the reader accepts."""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from ifgen import resources
from ifgen.cli import main
from ifgen.nodl import schema
from ifgen.nodl.model import Category
from jsonschema import Draft7Validator

from .conftest import load_from
from .test_mistakes import DOCUMENT, ENDPOINTS, OPTIONS, PARAMETERS, VALIDATORS, as_validator
from .test_robustness import WORDS

SCHEMA = schema.schema()
VALIDATOR = Draft7Validator(SCHEMA)
ROOT = Path(__file__).parents[2]
SHAPE = {"missing-key", "unknown-key", "wrong-value", "unknown-value", "nodl-version"}
"""Rules about the shape of a document alone."""
SHAPE_OF_VALIDATORS = {"unknown-validator", "unfit-validator"}


def takes(tree: object) -> bool:
    return bool(VALIDATOR.is_valid(tree))


def refused_by_reader(tree: object) -> set[str]:
    """The rules that a document breaks, warnings left out."""
    with tempfile.TemporaryDirectory() as folder:
        loaded = load_from(Path(folder), {"demo/nodl/talker.nodl.json": json.dumps(tree)})
    return {found.rule for found in loaded.diagnostics if found.severity == "error"}


BUNDLED = sorted(resources.bundled_interfaces().glob("*/nodl/*.yaml"))
EXAMPLES = sorted((Path(__file__).parent / "examples").iterdir())
TREES = [yaml.safe_load(path.read_text()) for path in (*BUNDLED, *EXAMPLES)]


def test_it_is_a_schema_and_the_page_has_it(capsys: pytest.CaptureFixture[str]) -> None:
    Draft7Validator.check_schema(SCHEMA)
    assert main.main(["nodl", "schema"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed) == SCHEMA
    if (page := ROOT / "docs/nodl.schema.json").exists():
        assert page.read_text() == printed, "run `ifgen nodl schema > docs/nodl.schema.json`"
        assert resources.NODL_SCHEMA.endswith("docs/nodl.schema.json")


def test_patterns_are_told_in_words() -> None:
    """Editors show `patternErrorMessage` instead of a regular expression."""
    shown = [SCHEMA["properties"][category]["items"] for category in Category]
    shown += [SCHEMA["definitions"][name] for name in ("Options", "TimerOptions")]
    for table in shown:
        for value in table["properties"].values():
            assert ("pattern" in value) == ("patternErrorMessage" in value)


def test_every_key_is_explained() -> None:
    """As an editor shows it: at the key, or at the definition that the key refers to."""
    tables = [SCHEMA, *SCHEMA["definitions"].values(), *(SCHEMA["properties"][c]["items"] for c in Category)]
    for table in tables:
        for name, value in table["properties"].items():
            assert "description" in value or "$ref" in value, name
    assert len(tables) > 10


@pytest.mark.parametrize("path", [*BUNDLED, *EXAMPLES], ids=lambda path: path.stem)
def test_descriptions_that_there_are(path: Path) -> None:
    assert [error.message for error in VALIDATOR.iter_errors(yaml.safe_load(path.read_text()))] == []


CASES = (*DOCUMENT, *ENDPOINTS, *PARAMETERS, *OPTIONS, *(as_validator(*case) for case in VALIDATORS))


@pytest.mark.parametrize(
    ("rule", "text", "said"),
    [case for case in CASES if case[0] in SHAPE | SHAPE_OF_VALIDATORS and "f" * 400 not in case[1]],
)
def test_known_mistakes(rule: str, text: str, said: str) -> None:
    assert not takes(yaml.safe_load(text.replace("⟦", "").replace("⟧", ""))), said


values = st.one_of(
    st.sampled_from(WORDS),
    st.none(),
    st.booleans(),
    st.integers(-2, 3) | st.integers(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.lists(st.integers(0, 3) | st.sampled_from(WORDS), max_size=2),
    st.dictionaries(st.sampled_from(WORDS), st.integers(0, 3), max_size=2),
)


def places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Every map and list of a document, with each of its keys or numbers."""
    children = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in children:
        yield tree, key
        yield from places(value)


@settings(max_examples=40)
@given(st.data())
def test_mutated_documents(data: st.DataObject) -> None:
    _agree_on_mutated(data)


@pytest.mark.slow
@settings(max_examples=150)
@given(st.data())
def test_many_mutated_documents(data: st.DataObject) -> None:
    _agree_on_mutated(data)


def _agree_on_mutated(data: st.DataObject) -> None:
    """A key left out, added or with another value; each way the reader and the schema agree."""
    tree = copy.deepcopy(data.draw(st.sampled_from(TREES)))
    holder, key = data.draw(st.sampled_from(list(places(tree))))
    match data.draw(st.sampled_from(["delete", "add", "replace"])):
        case "delete":
            del holder[key]
        case "add" if isinstance(holder, dict):
            holder.setdefault(data.draw(st.sampled_from(WORDS)), data.draw(values))
        case _:
            holder[key] = data.draw(values)
    assume(json.dumps(tree))
    broken = refused_by_reader(tree)
    if takes(tree):
        assert broken.isdisjoint(SHAPE | SHAPE_OF_VALIDATORS), broken
    else:
        assert broken, [error.message for error in VALIDATOR.iter_errors(tree)]
