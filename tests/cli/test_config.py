"""`[tool.ifgen]`: its meaning, and the errors of its mistakes."""

from __future__ import annotations

import hashlib
import os
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.command_kit import report
from ifgen.config import toml_text
from ifgen.config.customization import Customization, Output
from ifgen.config.model import Config, read_config
from ifgen.config.settings import Settings, settle
from ifgen.config.suppressions import Policy
from ifgen.diagnostics import Source, UsageError

from .conftest import Run


def write(folder: Path, text: str) -> Path:
    path = folder / "pyproject.toml"
    path.write_text(text)
    return path


def problem(tmp_path: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError) as caught:
        read_config(write(tmp_path, text), text.encode())
    return report.for_people(caught.value.diagnostics).plain


def test_paths_are_relative_to_the_file_and_options_win(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    below = tmp_path / "a/b"
    below.mkdir(parents=True)
    path = write(
        tmp_path,
        f'[tool.ifgen]\npaths = ["my interfaces", "{tmp_path}/here"]\noutput = "out"\nwith_deps = true\n',
    )
    write(tmp_path / "a", "[tool.other]\nx = 1\n")
    monkeypatch.chdir(below)
    (tmp_path / "my interfaces").mkdir()
    (tmp_path / "here").mkdir()
    found = settle(None, None, [Path("elsewhere")])
    assert found.file == path
    assert found.paths == (tmp_path / "my interfaces", tmp_path / "here")
    assert found.output == tmp_path / "out"
    assert found.with_deps
    assert found.custom == Customization()
    assert found.include == (Path("elsewhere"),)
    given = settle([Path("p")], Path("o"), None, False, Path("t"))
    custom = Customization(Path("t"), partial=True)
    assert given == Settings(
        paths=(Path("p"),),
        output=Path("o"),
        include=(),
        exclude=(),
        with_deps=False,
        custom=custom,
        policy=Policy(base=tmp_path),
        config=found.config,
    )
    assert (found.config.file, found.config.adapters) == (path, tmp_path / "adapters")


def test_no_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert settle() == Settings(
        paths=(),
        output=Path("generated"),
        include=(),
        exclude=(),
        with_deps=False,
        custom=Customization(),
        policy=Policy(),
        config=Config(),
    )
    with pytest.raises(UsageError, match=r"no pyproject.toml with \[tool.ifgen\]"):
        settle().with_paths()


def test_a_path_that_does_not_exist(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path, '[tool.ifgen]\npaths = ["gone"]\n')
    with pytest.raises(UsageError) as caught:
        settle()
    assert report.for_people(caught.value.diagnostics).plain == (
        f"error[configuration]: 'paths' in [tool.ifgen] names {tmp_path}/gone, which does not exist\n"
        " --> pyproject.toml:2:1\n"
        "  |\n"
        '2 | paths = ["gone"]\n'
        "  | ^^^^^\n"
        "  = help: `ifgen new interface demo_msgs/msg/Name` makes it\n"
    )
    assert settle([Path()]).paths == (Path(),), "an option wins over a wrong key"


def test_unknown_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = '[project]\nwithdeps = 1\n[tool.ifgen]\npaths = ["a"]\nwithdeps = true\n'
    assert problem(tmp_path, text, monkeypatch) == (
        "error[configuration]: [tool.ifgen] has no key 'withdeps'\n"
        " --> pyproject.toml:5:1\n"
        "  |\n"
        "5 | withdeps = true\n"
        "  | ^^^^^^^^ unknown key\n"
        "  = help: did you mean 'with_deps'?\n"
    )


def test_every_mistake_is_reported_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = '[tool.ifgen]\npaths = "interfaces"\nwith_deps = "yes"\noutput = 3\ninclude = ["a", 1]\nnonsense = 1\n'
    assert problem(tmp_path, text, monkeypatch) == (
        "error[configuration]: 'paths' in [tool.ifgen] must be a list of paths, such as [\"interfaces\"]\n"
        " --> pyproject.toml:2:1\n"
        "  |\n"
        '2 | paths = "interfaces"\n'
        '  | ^^^^^ found "interfaces"\n'
        "\n"
        "error[configuration]: 'output' in [tool.ifgen] must be a path in quotes\n"
        " --> pyproject.toml:4:1\n"
        "  |\n"
        "4 | output = 3\n"
        "  | ^^^^^^ found 3\n"
        "\n"
        "error[configuration]: 'include' in [tool.ifgen] must be a list of paths, such as [\"interfaces\"]\n"
        " --> pyproject.toml:5:1\n"
        "  |\n"
        '5 | include = ["a", 1]\n'
        "  | ^^^^^^^ found 1\n"
        "\n"
        "error[configuration]: 'with_deps' in [tool.ifgen] must be true, false or \"own\"\n"
        " --> pyproject.toml:3:1\n"
        "  |\n"
        '3 | with_deps = "yes"\n'
        '  | ^^^^^^^^^ found "yes"\n'
        "\n"
        "error[configuration]: [tool.ifgen] has no key 'nonsense'\n"
        " --> pyproject.toml:6:1\n"
        "  |\n"
        "6 | nonsense = 1\n"
        "  | ^^^^^^^^ unknown key\n"
        "  = help: the keys are paths, output, include, exclude, with_deps, tests,\n          templates, filters, outputs, generate, python, distributions,\n          requirements, ignore, per_file_ignores, strict, breaking, adapters,\n          ros_distro\n"
    )


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("[tool]\nifgen = { pathz = [] }\n", "2:11"),
        ("tool.ifgen.pathz = []\n", "1:12"),
        ("[tool.ifgen]\n[tool.ifgen.pathz]\n", "2:13"),
        ("[ tool . ifgen ]\n'pathz' = []\n", "2:1"),
        ("[tool]\nifgen = 3\n", "2:1"),
        ("[tool.ifgen]\noutputs = 3\n", "2:1"),
        ("[tool.ifgen]\noutputs = { docs = 3 }\n", "2:13"),
        ("[tool.ifgen.outputs]\ndocs = 3\n", "2:1"),
        ("[tool.ifgen.outputs]\ndocs = { template = 'a', path = 'b', per = 'all' }\n", "2:38"),
        ("[tool.ifgen.outputs.docs]\nper = 'run'\npath = 'b'\n", "1:21"),
        ("[tool.ifgen.outputs.docs]\ntemplate = 'a'\npath = 'b'\n'per' = 3\n", "4:1"),
        (
            "[tool.ifgen]\noutputs.docs.per = 3\noutputs.docs.path = 'a'\noutputs.docs.template = 'a'\n",
            "2:14",
        ),
        (
            "[ tool . ifgen . 'outputs' . \"docs\" ]\ntemplate = 'a'\npath = 'b'\nper = 'run'\nnope = 1\n",
            "5:1",
        ),
    ],
)
def test_the_place_is_found_in_every_spelling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, place: str
) -> None:
    assert f"pyproject.toml:{place}\n" in problem(tmp_path, text, monkeypatch)


def test_toml_syntax(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert problem(tmp_path, '[tool.ifgen]\npaths = ["a"\noutput = 1\n', monkeypatch) == (
        "error[configuration]: pyproject.toml is not valid TOML\n"
        " --> pyproject.toml:3:1\n"
        "  |\n"
        "3 | output = 1\n"
        "  | ^ unclosed array\n"
    )
    assert "invalid statement" in problem(tmp_path, "a = 1\n?", monkeypatch)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "pyproject.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="is not UTF-8"):
        read_config(path, path.read_bytes())


VALUES = st.sampled_from(
    ['"a"', "1", "1.5", "true", "[]", '["a"]', "[1]", "{}", "{ a = 1 }", "2020-01-01", "\n", '"']
)
KEYS = st.sampled_from(
    [
        *(field.name for cls in (Config, Output) for field in fields(cls)),
        "pathz",
        "outputs.docs",
        "outputs.docs.per",
        '"paths"',
        "'a b'",
        "a.b",
        "",
        "[tool.ifgen.paths]",
    ]
)
LINES = st.lists(st.tuples(KEYS, VALUES).map(lambda pair: f"{pair[0]} = {pair[1]}"), max_size=4)


@given(
    st.sampled_from(
        [
            "[tool.ifgen]\n",
            "[tool.ifgen.outputs.docs]\n",
            "[tool.ifgen.outputs]\n",
            "[[tool.ifgen]]\n",
            "tool.ifgen.",
            "[tool]\nifgen.",
            "[tool]\nifgen = ",
        ]
    ),
    LINES,
)
def test_any_table_is_read_or_refused_with_a_place(
    tmp_path_factory: pytest.TempPathFactory, head: str, lines: list[str]
) -> None:
    path = write(tmp_path_factory.mktemp("c"), head + "\n".join(lines) + "\n")
    try:
        read_config(path, path.read_bytes())
    except UsageError as error:
        assert error.diagnostics
        assert all(d.primary is not None for d in error.diagnostics)
        report.for_people(error.diagnostics)


PIECES = st.sampled_from(
    ["a", "[", "]", "{", "}", "=", ".", ",", '"', "'", "\n", "\\", "\\u0000", "1", "[" * 400, "a." * 150, "9" * 5000, "#", "é"]
)  # fmt: skip


@given(st.lists(PIECES, max_size=30).map("".join))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        assert toml_text.parse(Source(Path("pyproject.toml"), text)) is not None
    except UsageError as error:
        assert report.for_people(error.diagnostics).plain


def test_places_in_any_document() -> None:
    text = """\
# [a]
[tool.'x y']  # [b]
a.b."c d" = [ "]", {q = 1, "r" = '}'}, [ 2, # ]
  3 ] ]
s = \"\"\"
k = 1
\"\"\"
t = '''\nu = 2\n'''
date = 2020-01-01 00:00:00
[[tool.z]]
w = { x = { y = 1 }, z = "}" }
v = 1
"""
    text = text.replace("\\n", "\n")
    found = {".".join(path): text[start:end] for path, (start, end) in toml_text.places(text).items()}
    assert list(found) == [
        *("tool", "tool.x y", "tool.x y.a", "tool.x y.a.b", "tool.x y.a.b.c d", "tool.x y.a.b.c d.q"),
        *("tool.x y.a.b.c d.r", "tool.x y.s", "tool.x y.t", "tool.x y.date", "tool.z", "tool.z.w"),
        *("tool.z.w.x", "tool.z.w.x.y", "tool.z.w.z", "tool.z.v"),
    ]
    assert all(path.endswith(word.strip("'\"")) for path, word in found.items())
    tomllib.loads(text)


@given(st.text(st.sampled_from("ab.=[]{},#\"' \n\\\t1"), max_size=40))
def test_places_end_for_any_text(text: str) -> None:
    for path, (start, end) in toml_text.places(text).items():
        assert text[start:end].strip("\"'") == path[-1]


def test_what_was_said_is_kept(tmp_path: Path, cache_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cached configuration is the same; the cache is valid only for this file and contents, and may be damaged."""
    (tmp_path / "types").mkdir()
    (tmp_path / "t").mkdir()
    text = '[tool.ifgen]\npaths = ["types"]\ntemplates = "t"\ntests = false\n'
    text += '[tool.ifgen.outputs.a]\ntemplate = "a.j2"\npath = "{package}.md"\nper = "package"\nonly = ["x", "y"]\n'
    file = write(tmp_path, text)
    first = settle()
    parsed: list[Source] = []
    parse = toml_text.parse
    monkeypatch.setattr(toml_text, "parse", lambda source: parsed.append(source) or parse(source))
    assert settle() == first
    assert parsed == []
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    [cached] = [path for path in (cache_folder / "ifgen/config").iterdir() if digest in path.read_text()]
    for damaged in (
        b"",
        b"\xff",
        b"[]",
        b'{"digest": 1}',
        cached.read_bytes().replace(b'"paths"', b'"path"'),
    ):
        cached.write_bytes(damaged)
        assert settle() == first
    assert len(parsed) == 5
    file.write_text(text.replace("false", "true"))
    assert settle().custom.tests
    file.write_text("[tool]  # no longer about ifgen\n")
    assert [settle().file, settle().file] == [None, None]
    file.write_text("[tool.ifgen]\nwith_deps = 1\n")
    for _ in range(2):  # a wrong configuration is not cached
        with pytest.raises(UsageError, match="with_deps"):
            settle()
    assert len(parsed) == 9


MARK = 'from pathlib import Path\n(Path(__file__).parent / "ran").touch()\n'


@pytest.fixture
def with_filters(tmp_path: Path, demo_msgs: Path) -> Path:
    """A project whose filters create a file when they run."""
    write(
        tmp_path, f'[tool.ifgen]\npaths = ["{demo_msgs.name}"]\nfilters = "filters.py"\ntemplates = "own"\n'
    )
    (tmp_path / "filters.py").write_text(MARK)
    (tmp_path / "own").mkdir()
    return tmp_path / "ran"


@pytest.mark.parametrize(
    "command",
    [
        *("check", "show demo_msgs/msg/Pose", "hash demo_msgs", "graph demo_msgs", "rules keyword-name"),
        *("templates list", "templates diff", "templates context demo_msgs/msg/Pose", "nodl --help"),
        *("new interface demo_msgs/msg/Other", "completion bash", "generate --isolated demo_msgs"),
        "generate --check --isolated demo_msgs",
    ],
)
def test_who_only_reads_runs_no_code_of_a_project(ifgen: Run, with_filters: Path, command: str) -> None:
    ifgen(*command.split())
    assert not with_filters.exists()


@pytest.mark.parametrize("command", ["generate", "generate --check", "templates check"])
def test_who_renders_runs_the_filters(ifgen: Run, with_filters: Path, command: str) -> None:
    ifgen(*command.split())
    assert with_filters.exists()


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="there are no owners")
def test_code_of_another_user_above_the_working_folder(
    ifgen: Run, with_filters: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = with_filters.with_name("pyproject.toml")
    below = file.parent / "mine"
    below.mkdir()
    monkeypatch.chdir(below)
    assert ifgen("generate").code == 0
    with_filters.unlink()
    if os.getuid() == 0:
        os.chown(file, 54321, -1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: file.stat().st_uid + 1)
    done = ifgen("generate")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"error[configuration]: {file} belongs to another user, and names")
    assert not with_filters.exists()
    assert ifgen("generate", "--isolated", "../demo_msgs").code == 0
    assert not with_filters.exists()
    monkeypatch.chdir(file.parent)
    assert ifgen("generate", "-o", "anew").code == 0
    assert with_filters.exists()
