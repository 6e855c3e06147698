"""The model as JSON: its schema, its values, and what it promises to readers."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from ifgen import model
from ifgen.model import Model, document, read, schema, to_text
from ifgen.pipeline.generators import kit
from ifgen.pipeline.model import load_model

from ..generated_tests.definitions import packages, write

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """The model of the kit's corpus, which has every trap, and of a package with nodes."""
    folder = tmp_path_factory.mktemp("corpus")
    kit.write_corpus(folder)
    return load_model(folder, ROOT / "examples/templates/reference/interfaces")


def test_the_document_fits_its_schema(loaded: Model) -> None:
    text = to_text(loaded)
    jsonschema.Draft202012Validator(schema()).validate(json.loads(text))
    assert json.loads(text)["$schema"] == schema()["$id"]


def test_the_published_schema_is_that_of_the_code() -> None:
    assert json.loads((ROOT / "docs/model-1.schema.json").read_text()) == schema()


def test_a_document_is_read_back_as_it_was_whatever_else_is_in_it(loaded: Model) -> None:
    found = document(loaded)
    assert document(read(json.loads(json.dumps(found)))) == json.loads(json.dumps(found))
    later = {**found, "model": "1.9", "more": 1, "types": [{**of, "more": {}} for of in found["types"]]}
    assert read(later).types == read(found).types
    with pytest.raises(ValueError, match=r"this is version 2\.0 of the model"):
        read({**found, "model": "2.0"})


@pytest.mark.slow
def test_the_documents_of_what_comes_with_ifgen_fit() -> None:
    found = json.loads(to_text(load_model(ROOT / "interfaces", ROOT / "tests/conformance/interfaces")))
    assert len(found["types"]) > 400
    jsonschema.Draft202012Validator(schema()).validate(found)


@pytest.mark.slow
def test_the_documents_of_1000_drawn_interfaces_fit() -> None:
    validator, count = jsonschema.Draft202012Validator(schema()), 0

    @settings(max_examples=500, suppress_health_check=list(HealthCheck))
    @given(packages())
    def fits(files: dict[str, str]) -> None:
        nonlocal count
        with TemporaryDirectory() as folder:
            write(files, Path(folder) / "any_msgs")
            found = load_model(folder)
        text = to_text(found)
        validator.validate(json.loads(text))
        assert to_text(read(json.loads(text))) == text
        count += len(files)

    fits()
    assert count >= 1000


def test_wide_strings_bytes_and_large_integers_as_values(tmp_path: Path) -> None:
    write(
        {
            "msg/V.msg": 'wstring WIDE="𝄞 größe"\nbyte OCTET=200\nint64 EDGE=9007199254740991\n'
            "uint64 BEYOND=9007199254740992\nint64 LEAST=-9223372036854775808\n"
            'wstring wide "𝄞"\nbyte[2] octets [0, 255]\nchar letter 65\nuint64[] many [9007199254740993]\n'
        },
        tmp_path / "v_msgs",
    )
    [message] = document(load_model(tmp_path))["types"]
    constants = {of["name"]: of["exact_value"] for of in message["constants"]}
    assert constants["WIDE"] == {"value": "𝄞 größe", "exact": "𝄞 größe", "bits": None}
    assert constants["OCTET"]["value"] == 200
    assert constants["EDGE"]["value"] == 2**53 - 1 and constants["BEYOND"]["value"] == str(2**53)
    assert constants["LEAST"]["value"] == constants["LEAST"]["exact"] == "-9223372036854775808"
    wide, octets, letter, many = message["fields"]
    assert wide["default_value"]["value"] == "𝄞" and letter["default_value"]["value"] == 65
    assert [of["value"] for of in octets["default_elements"]] == [0, 255]
    assert [of["value"] for of in many["default_elements"]] == ["9007199254740993"]


def values(loaded: Model, name: str) -> dict[str, dict[str, Any]]:
    message = loaded.type(name)
    return {of.name: model.plain(of.exact_value) for of in message.constants}


def test_values_are_exact(loaded: Model) -> None:
    integers = values(loaded, "trap_msgs/msg/IntegerConstants")
    assert integers["UINT64_MAX"] == {
        "value": "18446744073709551615",
        "exact": "18446744073709551615",
        "bits": None,
    }
    assert integers["BEYOND"]["value"] == "9007199254740993"
    assert integers["OCTET"]["value"] == 255 and integers["YES"]["value"] is True
    floats = values(loaded, "trap_msgs/msg/FloatConstants")
    assert floats["TENTH"] == {"value": 0.1, "exact": "0.1", "bits": "0x3dcccccd"}
    assert floats["LARGE"]["exact"] == "3.4028234e+38" and floats["TINY"]["bits"] == "0x00000001"
    assert floats["NEGATIVE_ZERO"]["bits"] == "0x8000000000000000"
    assert floats["SMALLEST"] == {"value": 5e-324, "exact": "5e-324", "bits": "0x0000000000000001"}


def test_derived_messages_have_their_own_hashes(loaded: Model) -> None:
    kinds = {of.kind: of for of in loaded.types if of.interface == "trap_msgs/action/Walk"}
    assert len(kinds) == 10 and len({of.type_hash for of in kinds.values()}) == 10
    assert kinds["feedback_message"].description["type_description"]["type_name"].endswith("_FeedbackMessage")
    [interface] = [i for p in loaded.packages for i in p.interfaces if i.id == "trap_msgs/action/Walk"]
    assert [service.name for service in interface.services] == ["Walk_SendGoal", "Walk_GetResult"]


def test_the_hashes_are_those_of_ifgen_hash(loaded: Model) -> None:
    import ifgen

    for name in ("geometry_msgs/msg/Point", "std_msgs/msg/Header"):
        assert loaded.type(name).type_hash == ifgen.type_hash(name)


def test_what_is_only_needed_says_so(loaded: Model) -> None:
    assert not loaded.type("geometry_msgs/msg/Point").generate
    assert loaded.type("trap_msgs/msg/Foreign").generate
    assert {p.name for p in loaded.packages if not p.generate} >= {"geometry_msgs", "std_msgs"}


def test_names_that_a_language_keeps(loaded: Model) -> None:
    names = {of.name: of.names for of in loaded.type("trap_msgs/msg/Words").fields}
    assert names["type"]["rust"] == "type_" and names["type"]["typescript"] == "type"
    assert names["constructor"]["typescript"] == "constructor_" and names["func"]["go"] == "func_"


def test_constants_belong_to_fields(loaded: Model) -> None:
    state, mode = loaded.type("trap_msgs/msg/States").fields
    assert (state.constants, mode.constants) == (("STATE_OFF", "STATE_ON"), ("MODE_A", "MODE_B"))


def test_a_full_definition_has_all_that_it_needs(loaded: Model) -> None:
    [letters] = [i for p in loaded.packages for i in p.interfaces if i.name == "Letters"]
    assert letters.full_definition.startswith("int32 id\nuint8 letter\n")  # as .msg, for readers of bags
    [foreign] = [i for p in loaded.packages for i in p.interfaces if i.name == "Foreign"]
    heads = re.findall(r"^={80}\nMSG: (\S+)$", foreign.full_definition, re.MULTILINE)
    assert "geometry_msgs/Quaternion" in heads and "builtin_interfaces/Time" in heads


def test_the_command_and_the_page(tmp_path: Path) -> None:
    page = (ROOT / "docs/model.md").read_text()
    definitions = re.findall(r"`(\w+\.(?:msg|srv))`[^\n]*\n\n```\n(.*?)```", page, re.DOTALL)
    for name, text in definitions:
        path = tmp_path / "demo_msgs" / name.partition(".")[2] / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    run = [sys.executable, "-m", "ifgen", "model", str(tmp_path)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=60, check=True, cwd=tmp_path)
    found = json.loads(done.stdout)
    elements = {of["id"]: of for of in found["types"]}
    elements |= {of["id"]: of for p in found["packages"] for of in p["interfaces"] if of["kind"] != "message"}
    shown = [json.loads(text) for text in re.findall(r"```json\n(.*?)```", page, re.DOTALL)]
    assert len(shown) == len(definitions) == 2
    for element in shown:
        assert is_part(element, elements[element["id"]])


def is_part(shown: Any, found: Any) -> bool:
    """Whether a value is the other one, except where it has three dots."""
    if isinstance(shown, dict):
        return shown.keys() == found.keys() and all(is_part(of, found[name]) for name, of in shown.items())
    if isinstance(shown, list):
        return len(shown) == len(found) and all(map(is_part, shown, found))
    return shown in ("...", found)
