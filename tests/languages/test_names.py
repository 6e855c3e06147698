"""Names: two that become one in a language are refused, and those of its own types are no problem."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from ifgen.generators import Finding, Generator
from ifgen.model import LANGUAGES, RESERVED, Model, safe_name
from ifgen_generators.c import GENERATOR as C
from ifgen_generators.cpp import GENERATOR as CPP
from ifgen_generators.rust import GENERATOR as RUST
from ifgen_generators.typescript import GENERATOR as TYPESCRIPT

from ..conformance.support import TYPESCRIPT as PACKAGES
from ..conformance.support import node_modules, tool
from .c_family.support import generate as response_of
from .c_family.support import load, write
from .support import run
from .testees import compiled_typescript

GENERATORS = {generator.name: generator for generator in (C, CPP, RUST, TYPESCRIPT)}
# Names of types in one of the languages, or in the code that we write in it.
TYPES = (
    *("Array", "Boolean", "Box", "Cow", "Date", "Drop", "Err", "Error", "Float64Array", "Map", "Message"),
    *("Number", "Ok", "Option", "Partial", "Promise", "Reader", "Record", "Result", "Service", "Set", "Some"),
    *("String", "Symbol", "Uint8Array", "Vec", "View", "Writer"),
)


def thing(folder: Path, text: str, name: str = "Thing") -> Path:
    path = folder / "a_msgs/msg" / name
    path = path.with_name(name if "." in name else f"{name}.msg")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return folder / "a_msgs"


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load(thing(tmp_path_factory.mktemp("names"), "int32 one\nint32 two\n"))


def renamed(model: Model, *names: str) -> Model:
    (message,) = (message for message in model.types if message.name == "Thing")
    fields = tuple(
        replace(field, name=name, names={language: safe_name(name, language) for language in LANGUAGES})
        for field, name in zip(message.fields, names, strict=True)
    )
    return replace(model, types=(replace(message, fields=fields),))


def findings(generator: Generator, model: Model) -> tuple[Finding, ...]:
    return response_of(generator, model, **({"bounds": {}} if generator is C else {})).findings


@pytest.mark.parametrize("language", GENERATORS)
def test_fields_that_get_one_name_are_refused_at_the_second(model: Model, language: str) -> None:
    for word in sorted(RESERVED[language]):
        (finding,) = findings(GENERATORS[language], renamed(model, word, f"{word}_"))
        assert finding.element == "a_msgs/msg/Thing.two"
        assert finding.message == (
            f"the field `{word}_` has the name `{word}_`, as `{word}` has in {language}"
        )
        assert findings(GENERATORS[language], renamed(model, f"{word}_", word))[0].element == finding.element


@pytest.mark.parametrize("language", GENERATORS)
def test_other_languages_words_do_not_clash(model: Model, language: str) -> None:
    words = set().union(*RESERVED.values()) - RESERVED[language]
    for word in sorted(words):
        assert findings(GENERATORS[language], renamed(model, word, f"{word}_")) == ()


def test_the_error_is_at_the_place_of_the_field(tmp_path: Path) -> None:
    text = "module a_msgs { module msg {\n  struct Thing {\n    long template;\n    long template_;\n  };\n}; };\n"
    thing(tmp_path, text, "Thing.idl")
    config = '[tool.ifgen]\npaths = ["a_msgs"]\npython = false\n[tool.ifgen.generate.cpp]\nuse = "cpp"\nout = "o"\n'
    (tmp_path / "pyproject.toml").write_text(config)
    command = [sys.executable, "-m", "ifgen", "generate"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert "cpp: the field `template_` has the name `template_`, as `template` has in cpp" in done.stderr
    assert "a_msgs/msg/Thing.idl:4:10" in done.stderr
    assert not (tmp_path / "o").exists()


def test_a_message_may_not_have_the_name_of_a_view(tmp_path: Path) -> None:
    thing(tmp_path, "string data\n")
    model = load(thing(tmp_path, "int32 data\n", "ThingView"))
    (finding,) = response_of(RUST, model).findings
    assert (finding.element, finding.message) == (
        "a_msgs/msg/ThingView",
        "the message `ThingView` has the name of the view of Thing",
    )
    assert response_of(RUST, model, views=False).findings == ()


def test_a_constant_may_not_have_the_name_of_a_member(tmp_path: Path) -> None:
    constants = "module Thing_Constants { const long encode = 3; };"
    text = f"module a_msgs {{ module msg {{ {constants} struct Thing {{ long a; }}; }}; }};\n"
    model = load(thing(tmp_path, text, "Thing.idl"))
    (finding,) = response_of(TYPESCRIPT, model).findings
    assert finding.message == "the constant `encode` has the name of something else in typescript"
    assert response_of(RUST, model).findings == ()


def test_a_keyword_as_a_type_is_refused(tmp_path: Path) -> None:
    model = load(thing(tmp_path, "int32 data\n", "Self"))
    (finding,) = response_of(RUST, model).findings
    assert finding.message == "`Self` in a_msgs/msg/Self is a keyword of rust"


@pytest.mark.slow
@pytest.mark.parametrize("language", GENERATORS)
def test_types_with_names_of_the_language(tmp_path: Path, language: str) -> None:
    fields = "float64[] data\nuint8[3] bytes\nint64 i 3\nbool b true\nstring<=9 s\nOne[<=2] h\nOne[2] hh\nOne one\n"
    for name in TYPES:
        thing(tmp_path, fields.replace("[]", "[<=3]"), name)
    model = load(thing(tmp_path, "string<=9 x\n", "One"))
    folder = write(response_of(GENERATORS[language], model), tmp_path / "code")
    headers = sorted(folder.rglob("*.h*"))
    (tmp_path / "all.c").write_text("".join(f'#include "{path}"\n' for path in headers))
    match language:
        case "c":
            run([tool("gcc"), "-std=c99", f"-I{folder}", "-fsyntax-only", str(tmp_path / "all.c")], tmp_path)
        case "cpp":
            command = [tool("g++"), "-std=c++17", f"-I{folder}", "-fsyntax-only", "-x", "c++"]
            run([*command, str(tmp_path / "all.c")], tmp_path)
        case "rust":
            run([tool("cargo"), "check", "--offline", "--quiet"], folder)
        case _:
            compiled_typescript(node_modules(tmp_path, PACKAGES) / ".bin/tsc", folder)
