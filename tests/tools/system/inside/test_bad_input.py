"""Launch files and manifests that cannot be read: one error with its places, never a traceback."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, strategies
from ifgen.diagnostics import InputError, Source
from ifgen_tools.system import manifest
from ifgen_tools.system.build import Request, build

from . import systems

HEAD = "from launch import LaunchDescription\ndef generate_launch_description():\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def error_of(name: str, **options: bool) -> str:
    with pytest.raises(InputError) as caught:
        build(Request(launch_files=(Path(name),), arguments={}, transport="local", **options))
    (found,) = caught.value.diagnostics
    assert found.rule == "system-launch-file"
    places = [
        f"{label.span.source.path.name}:{label.span.line}"
        for label in (found.primary, *found.secondary)
        if label is not None
    ]
    return f"{' '.join(places)}: {found.message}"


def test_files_that_include_each_other() -> None:
    for name, other in (("a", "b"), ("b", "a")):
        text = f'<launch>\n  <include file="$(dirname)/{other}.launch.xml"/>\n</launch>\n'
        Path(f"{name}.launch.xml").write_text(text)
    found = error_of("a.launch.xml")
    assert found.endswith(": launch files include each other without an end")
    assert "a.launch.xml:2" in found and "b.launch.xml:2" in found


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        (
            "a.launch.py",
            f"{HEAD}    raise OSError(5, 'no luck')\n",
            "a.launch.py:3: OSError: [Errno 5] no luck",
        ),
        ("a.launch.py", f"{HEAD}    return 3\n", "a.launch.py:1: generate_launch_description() must return"),
        ("a.launch.py", "def (", "a.launch.py:1: invalid syntax"),
        ("a.launch.py", "raise SystemExit('bye')", "a.launch.py:1: SystemExit: bye"),
        ("a.launch.xml", "<launch><node/></launch>", "a.launch.xml:1: 'node' needs the attribute 'exec'"),
        ("a.launch.xml", "<!DOCTYPE l [<!ENTITY e 'x'>]><launch/>", "a.launch.xml:1: entities of XML"),
        ("a.launch.yaml", "launch: &a [*a]\n", "a.launch.yaml:1: "),
        ("a.launch.yaml", "launch:\n" + "- " * 200, "a.launch.yaml:"),
        ("a.launch.yaml", "a: !!python/object/apply:os.system [true]", "a.launch.yaml:1: "),
        ("a.launch.xml", "<launch><include file='none.launch.py'/></launch>", "a.launch.xml:1: cannot read"),
    ],
)
def test_a_launch_file_that_cannot_be_evaluated(name: str, text: str, expected: str) -> None:
    Path(name).write_text(text)
    assert error_of(name).startswith(expected)


def test_python_is_not_run_if_that_is_refused() -> None:
    Path("a.launch.py").write_text("open('ran', 'w')\n")
    Path("b.launch.xml").write_text("<launch><include file='$(dirname)/a.launch.py'/></launch>")
    Path("c.launch.xml").write_text("""<launch><let name="a" value="$(eval 'open(1)')"/></launch>""")
    assert "is Python, which --no-python does not run" in error_of("a.launch.py", with_python=False)
    assert "is Python, which --no-python does not run" in error_of("b.launch.xml", with_python=False)
    assert "is not to be run" in error_of("c.launch.xml", with_python=False)
    assert not Path("ran").exists()


def test_nothing_is_started() -> None:
    Path("a.launch.xml").write_text(
        """<launch><executable cmd="touch ran"/><timer period="1"><executable cmd="touch ran"/></timer>
        <node exec="x"><param name="p" value="$(command 'touch ran')"/></node></launch>"""
    )
    built = build(Request(launch_files=(Path("a.launch.xml"),), arguments={}, transport="local"))
    assert [command.words[0] for command in built.system.commands] == ["touch", "touch"]
    assert not Path("ran").exists()


GOOD = {
    "version": 1,
    "open_ends": [],
    "nodes": {
        "/a": {
            "package": "p",
            "executable": "a",
            "endpoints": [
                {
                    "category": "publishers",
                    "name": "/x",
                    "type": "std_msgs/msg/String",
                    "qos": {"history": "KEEP_LAST", "depth": 1, "reliability": "RELIABLE"},
                }
            ],
        }
    },
}


def parsed(text: str) -> manifest.Manifest:
    return manifest.parse(Source(Path("ifgen.system.lock"), text))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"version": 1', '"version": 2', "this manifest is of version 2, and this ifgen reads 1"),
        ('"version": 1', '"version": true', "the version must be 1"),
        ('"nodes"', '"knots"', "a manifest has no key `knots`"),
        ('"publishers"', '"readers"', "`readers` is no kind of endpoint"),
        ('"KEEP_LAST"', '"SOME"', "`history` of a QoS profile cannot be 'SOME'"),
        ('"depth": 1', '"depth": -1', "`depth` of a QoS profile cannot be -1"),
        ('"type": "std_msgs/msg/String"', '"type": 3', "`type` must be a text"),
        ('"open_ends": []', '"open_ends": [1]', "`open_ends` must be a list of names"),
        ("{", "", "this is no JSON: Extra data"),
    ],
)
def test_a_manifest_that_is_wrong(old: str, new: str, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        parsed(json.dumps(GOOD, indent=1).replace(old, new, 1))
    (found,) = caught.value.diagnostics
    assert found.rule == "system-manifest"
    assert found.primary is not None
    assert found.message == expected


_SCALARS = strategies.none() | strategies.booleans() | strategies.integers() | strategies.text(max_size=8)
_WORDS = (
    "version",
    "open_ends",
    "nodes",
    "/a",
    "package",
    "executable",
    "endpoints",
    "category",
    "qos",
    "name",
)
_JSON = strategies.recursive(
    _SCALARS | strategies.just(1),
    lambda inner: (
        strategies.lists(inner, max_size=3)
        | strategies.dictionaries(strategies.sampled_from(_WORDS), inner, max_size=4)
    ),
    max_leaves=20,
)


@given(_JSON.map(json.dumps) | strategies.text(max_size=40))
def test_any_text_is_a_manifest_or_one_error(text: str) -> None:
    try:
        parsed(text)
    except InputError as error:
        assert len(error.diagnostics) == 1


@given(strategies.integers(0, 300), strategies.sampled_from('{}[]",:0 \0'), strategies.booleans())
def test_a_manifest_with_one_other_character(at: int, character: str, replaces: bool) -> None:
    text = json.dumps(GOOD)
    at = min(at, len(text) - 1)
    try:
        parsed(text[:at] + character + text[at + replaces :])
    except InputError as error:
        assert len(error.diagnostics) == 1


def test_a_manifest_survives_being_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    systems.write(systems.NAVIGATION, folder)
    request = Request(
        launch_files=(Path("rover_nav/launch/nav.launch.py"),),
        arguments={},
        packages=(Path("rover_nav"),),
        transport="local",
    )
    content = manifest.of_system(build(request).system)
    assert parsed(manifest.text(content)) == content
