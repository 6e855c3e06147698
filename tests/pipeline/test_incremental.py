"""After an edit, only what the edit reaches is rendered again, and the output is that of a first run."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import ifgen
import pytest
from click.testing import CliRunner
from ifgen.cli import main
from ifgen.config.customization import Customization, Distributions, Output
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.templates.render import Templates
from ifgen.pipeline import resolution
from ifgen.pipeline.values import ResolvedInput
from ifgen.writing.write import EDITED

WORKSPACE = {
    "base_msgs/msg/Stamp.msg": "# When.\nint32 sec\nuint32 nanosec 7\n",
    "base_msgs/msg/Point.msg": "float64 x # [m]\nfloat64 y\n",
    "base_msgs/msg/Path.msg": 'Stamp stamp\nPoint[] points\nstring name "a"\n',
    "top_msgs/msg/Top.msg": "base_msgs/Path path\nuint8 KIND_A=1\nuint8 KIND_B=2\nuint8 kind\n",
    "top_msgs/msg/Alone.msg": "int32 n\n",
    "top_msgs/srv/Ask.srv": "base_msgs/Point where\n---\nbool ok\n",
    "top_msgs/action/Walk.action": "Top goal\n---\nbool done\n---\nAlone state\n",
    "robot/nodl/arm.nodl.yaml": "nodl_version: 2\npublishers:\n"
    "  - {name: /place, type: base_msgs/Point, qos: {history: KEEP_LAST, depth: 5, reliability: RELIABLE}}\n",
    "robot/msg/Grip.msg": "base_msgs/Stamp stamp\nfloat32 force # [N]\n",
}
HOLDERS = {  # the interfaces that an edit reaches, besides the edited one
    "base_msgs/msg/Stamp": {
        "base_msgs/msg/Path",
        "top_msgs/msg/Top",
        "top_msgs/action/Walk",
        "robot/msg/Grip",
    },
    "base_msgs/msg/Point": {
        "base_msgs/msg/Path",
        "top_msgs/msg/Top",
        "top_msgs/action/Walk",
        "top_msgs/srv/Ask",
    },
    "base_msgs/msg/Path": {"top_msgs/msg/Top", "top_msgs/action/Walk"},
    "top_msgs/msg/Top": {"top_msgs/action/Walk"},
    "top_msgs/msg/Alone": {"top_msgs/action/Walk"},
}


@pytest.fixture(autouse=True)
def workspace(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for name, text in WORKSPACE.items():
        path = tmp_path / "ws" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "ws"


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The paths of all files that were rendered since it was last cleared."""
    paths: list[str] = []
    original = Templates.render

    def spy(templates: Templates, artifact: Artifact) -> OutputFile:
        paths.append(artifact.path)
        return original(templates, artifact)

    monkeypatch.setattr(Templates, "render", spy)
    return paths


@pytest.fixture
def resolved(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The inputs of the runs since it was last cleared: none if there was nothing to do."""
    runs: list[str] = []
    original = resolution.resolve

    def spy(*arguments: object) -> ResolvedInput:
        runs.append("read")
        return original(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(resolution, "resolve", spy)
    return runs


def modules(rendered: list[str]) -> set[str]:
    """The modules of interfaces among rendered files."""
    return {path for path in rendered if re.fullmatch(r"(robot/)?(msg|srv|action)/_[a-z]\w*\.py", path)}


def module_of(type_name: str) -> str:
    package, folder, name = type_name.split("/")
    inner = "robot/" if package == "robot" else ""
    return f"{inner}{folder}/_{name.lower()}.py"


def tree(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def check_against_a_first_run(custom: Customization | None = None) -> None:
    """Generate, and compare with the output of a run that knows nothing about earlier ones; the user's files stay."""
    for name in ("first", "over", "other_cache"):
        shutil.rmtree(name, ignore_errors=True)
    shutil.copytree("out", "over")
    done = ifgen.generate("ws", output="out", templates=custom)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(Path("other_cache").absolute()))
        again = ifgen.generate("ws", output="over", templates=custom)
        ifgen.generate("ws", output="first", templates=custom)
    assert tree(Path("over")) == tree(Path("out"))
    said = [
        (d.rule, d.message.replace("over/", "out/"), d.primary and d.primary.span.start)
        for d in again.diagnostics
    ]
    assert said == [(d.rule, d.message, d.primary and d.primary.span.start) for d in done.diagnostics]
    mine = {name for name, text in tree(Path("first")).items() if Path("out", name).read_bytes() != text}
    assert mine <= {"robot/robot/arm.py", "robot/test/test_arm.py"}, "what was written once is the user's"
    left = tree(Path("out")).keys() - tree(Path("first")).keys()
    left = {name for name in left if not name.startswith(EDITED)}
    assert left <= {"robot/test/test_arm.py"}


@pytest.mark.parametrize(
    "what",
    ["int8 extra\n", pytest.param("# A comment at the end.\n", marks=pytest.mark.slow)],
    ids=["field", "comment"],
)
def test_every_interface_edited_in_turn(rendered: list[str], workspace: Path, what: str) -> None:
    """Only that interface is rendered, those that contain it, and the files that their packages share."""
    ifgen.generate("ws", output="out")
    for name in WORKSPACE:
        type_name = name.rpartition(".")[0]
        if name.endswith(".yaml"):
            continue
        path = workspace / name
        path.write_text(path.read_text() + what)
        rendered.clear()
        ifgen.generate("ws", output="out")
        reached = {type_name} | HOLDERS.get(type_name, set())
        assert modules(rendered) == set(map(module_of, reached)), type_name
        rendered.clear()
        ifgen.generate("ws", output="out")
        assert rendered == []
        check_against_a_first_run()


def test_one_of_many_costs_little(rendered: list[str], workspace: Path) -> None:
    for index in range(60):
        (workspace / f"top_msgs/msg/More{index}.msg").write_text("base_msgs/Point at\n")
    ifgen.generate("ws", output="out")
    rendered.clear()
    (workspace / "top_msgs/msg/More7.msg").write_text("base_msgs/Point at\nint8 n\n")
    ifgen.generate("ws", output="out")
    shared = {"__init__.py", "py.typed", "msg/__init__.py", "srv/__init__.py", "action/__init__.py"}
    assert set(rendered) == {*shared, "msg/_more7.py", "test/test_top_msgs_interfaces.py"}


def test_interfaces_that_come_go_and_change_their_names(rendered: list[str], workspace: Path) -> None:
    ifgen.generate("ws", output="out")
    rendered.clear()
    (workspace / "top_msgs/msg/New.msg").write_text("Alone alone\n")
    ifgen.generate("ws", output="out")
    assert modules(rendered) == {"msg/_new.py"}
    check_against_a_first_run()
    (workspace / "top_msgs/msg/New.msg").rename(workspace / "top_msgs/msg/Newer.msg")
    rendered.clear()
    ifgen.generate("ws", output="out")
    assert modules(rendered) == {"msg/_newer.py"}
    assert not Path("out/top_msgs/msg/_new.py").exists()
    check_against_a_first_run()
    shutil.rmtree(workspace / "robot/nodl")  # its modules are in another folder now
    ifgen.generate("ws", output="out")
    assert Path("out/robot/msg/_grip.py").exists() and not Path("out/robot/robot/msg").exists()


@pytest.mark.parametrize(
    ("seed", "runs"), [(0, 4), *(pytest.param(seed, 12, marks=pytest.mark.slow) for seed in range(10))]
)
def test_any_sequence_of_changes(workspace: Path, seed: int, runs: int) -> None:
    """Edited, removed and reverted inputs and outputs, other templates and options, and clocks that go back."""
    draw = random.Random(seed)
    folder = Path("mine/message_package")
    folder.mkdir(parents=True)
    customs = [
        *(None, Customization(tests=False), Customization(Path("mine"))),
        *(Customization(filters=Path("f.py")), Customization(distributions=Distributions("acme-{package}"))),
    ]
    Path("f.py").write_text("def shout(text):\n    return text.upper()\n")

    def some(pattern: str) -> Path:
        where, _, what = pattern.partition("/")
        return draw.choice(sorted(Path(where).rglob(what)))

    def append(path: Path, text: str) -> None:
        path.write_text(path.read_text() + text)

    def in_the_past() -> None:
        for path in (some("ws/*.msg"), some("out/_*.py")):
            os.utime(path, (1e9, 1e9))

    changes: list[Callable[[], object]] = [
        lambda: append(some("ws/*.msg"), f"int8 n{draw.randrange(10**6)}\n"),
        lambda: append(some("ws/*.srv"), f"# {draw.random()}\n"),
        lambda: append(some("ws/*.msg"), f"int8 class{draw.randrange(10**6)}\nint8 lambda\n"),
        lambda: [(workspace / name).write_text(text) for name, text in WORKSPACE.items()],
        lambda: append(workspace / "robot/nodl/arm.nodl.yaml", f"# {draw.random()}\n"),
        lambda: (workspace / "top_msgs/package.xml").write_text(
            f"<package><name>top_msgs</name><version>{draw.randrange(9)}.0.0</version></package>"
        ),
        lambda: some("out/_*.py").unlink(),
        lambda: append(some("out/__init__.py"), "# edited\n"),
        lambda: append(Path("out/robot/robot/arm.py"), f"# {draw.random()}\n"),
        lambda: Path("out/robot/robot/arm.py").write_text(draw.choice(["def\n", "x = 1\n"])),
        lambda: (folder / "py.typed.j2").write_text(f"{draw.random()}"),
        lambda: append(Path("f.py"), f"# {draw.random()}\n"),
        in_the_past,
    ]
    custom = None
    ifgen.generate("ws", output="out")
    for _ in range(runs):
        for change in draw.sample(changes, draw.randrange(3)):
            before = tree(workspace)
            change()
            try:
                ifgen.load("ws")
            except ifgen.InputError:  # the same name twice
                for name, data in before.items():
                    (workspace / name).write_bytes(data)
        custom = draw.choice([custom, custom, *customs])
        check_against_a_first_run(custom)


def edited_template() -> Customization:
    Path("mine/message_package").mkdir(parents=True, exist_ok=True)
    Path("mine/message_package/py.typed.j2").write_text("typed\n")
    return Customization(Path("mine"))


def filters() -> Customization:
    Path("f.py").write_text("VALUE = 1\n")
    return Customization(filters=Path("f.py"))


def outputs() -> Customization:
    Path("mine").mkdir(exist_ok=True)
    Path("mine/list.j2").write_text("{{ package.name }}\n")
    return Customization(Path("mine"), outputs=(Output("list", "list.j2", "{package}/list.txt", "package"),))


@pytest.mark.parametrize("other", [edited_template, filters, outputs, lambda: Customization(tests=False)])
def test_other_options_render_everything(rendered: list[str], other: Callable[[], Customization]) -> None:
    ifgen.generate("ws", output="out")
    count = len(modules(rendered))
    for custom in (other(), None):
        rendered.clear()
        ifgen.generate("ws", output="out", templates=custom)
        assert len(modules(rendered)) == count
        check_against_a_first_run(custom)


def test_another_python_renders_everything(rendered: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    ifgen.generate("ws", output="out")
    everything = list(rendered)
    rendered.clear()
    monkeypatch.setattr(sys, "version", "4.0")
    ifgen.generate("ws", output="out")
    assert sorted(rendered) == sorted(everything)


def test_another_ifgen_has_generated_there_since(monkeypatch: pytest.MonkeyPatch, workspace: Path) -> None:
    """For example on another machine: the notes here are true, but about other files."""
    ifgen.generate("ws", output="out")
    text = '{% extends "ifgen/message_package/interface.py.j2" %}{% block additions %}# mine{% endblock %}'
    Path("mine/message_package").mkdir(parents=True)
    Path("mine/message_package/interface.py.j2").write_text(text)
    with monkeypatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(Path("their_cache").absolute()))
        ifgen.generate("ws", output="out", templates="mine")
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 n\nint32 m\n")
    check_against_a_first_run()


def test_every_file_of_the_toolkit_counts() -> None:
    from ifgen import resources
    from ifgen.pipeline.cache import fingerprints

    templates = resources.templates()
    before = fingerprints.of_generator(templates)
    for name in ("definition/idl.py", "generator_py/new/room.py", "idl/more.lark"):
        path = Path("copy") / name
        shutil.copytree(resources.PACKAGE, "copy", ignore=shutil.ignore_patterns("*.pyc"))
        path.parent.mkdir(exist_ok=True)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(resources, "PACKAGE", Path("copy").absolute())
            assert fingerprints.of_generator(templates) == before, "the place does not matter"
            path.write_text("")
            assert fingerprints.of_generator(templates) != before
        shutil.rmtree("copy")


def test_a_package_that_moved(workspace: Path) -> None:
    """Its manifest names its source."""
    ifgen.generate("ws", output="out")
    workspace.rename("elsewhere")
    ifgen.generate("elsewhere", output="out")
    ifgen.generate("elsewhere", output="first")
    for name in ("base_msgs", "top_msgs", "robot"):
        file = f"{name}/.ifgen-manifest.json"
        assert Path("out", file).read_bytes() == Path("first", file).read_bytes()


def test_what_every_action_needs_is_generated_with_it(rendered: list[str]) -> None:
    """No field of Walk.action names it."""
    ifgen.generate("ws", output="out", with_deps=True)
    shutil.rmtree("out/action_msgs")
    ifgen.generate("ws", output="out", with_deps=True)
    assert Path("out/action_msgs/msg/_goal_status_array.py").exists()


# Warnings


def test_warnings_do_not_make_work(resolved: list[str], workspace: Path) -> None:
    """They are repeated as they were first reported: with places, carets and help."""
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 class\n")
    (workspace / "top_msgs/package.xml").write_text("<package><name>top_msgs</name></package>")
    (workspace / "base_msgs/CMakeLists.txt").write_text("project(base_msgs)\n")
    first = CliRunner().invoke(main.commands, ["generate", "ws", "-o", "out"])
    assert first.stderr.count("warning[") == 3
    for _ in range(2):
        resolved.clear()
        again = CliRunner().invoke(main.commands, ["generate", "ws", "-o", "out"])
        assert (again.stderr, again.exit_code, resolved) == (first.stderr, 0, [])
        assert "up to date" in again.stdout
    strict = CliRunner().invoke(main.commands, ["generate", "ws", "-o", "out", "--strict"])
    assert strict.stderr.count("error[") == 3 and resolved == []
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 class # ifgen: ignore[keyword-name]\n")
    mended = CliRunner().invoke(main.commands, ["generate", "ws", "-o", "out"])
    assert mended.stderr.count("warning[") == 2


def test_warnings_are_those_of_what_is_asked_for(resolved: list[str], workspace: Path) -> None:
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 class\n")
    (workspace / "base_msgs/msg/Path.msg").write_text("int32 lambda\n")

    def said(*paths: str) -> list[str]:
        found = ifgen.generate(*paths, output="out", include=["ws"], with_deps=True).diagnostics
        return [diagnostic.message for diagnostic in found]

    both = said("ws")
    assert ["lambda" in message for message in both] == [True, False]
    for _ in range(2):
        assert said("ws/top_msgs") == both[1:], "what others wrote is for them to mend"
        assert said("ws/base_msgs") == both[:1]
        assert said("ws") == both
    said("ws/top_msgs")
    resolved.clear()
    assert said("ws/top_msgs") == both[1:] and resolved == []


@pytest.mark.parametrize("change", ["module", "new module", "package.xml", "CMakeLists.txt", "dependency"])
def test_what_warnings_come_of_counts(resolved: list[str], workspace: Path, change: str) -> None:
    (workspace / "top_msgs/package.xml").write_text(
        "<package><name>top_msgs</name><depend>in_between</depend></package>"
    )
    (workspace / "base_msgs/package.xml").write_text("<package><name>base_msgs</name></package>")
    between = Path("deps/in_between")
    (between / "msg").mkdir(parents=True)
    (between / "msg/A.msg").write_text("int8 a\n")
    (between / "package.xml").write_text(
        "<package><name>in_between</name><depend>base_msgs</depend></package>"
    )

    def said() -> list[str]:
        found = ifgen.generate("ws", output="out", include=["deps"]).diagnostics
        return [diagnostic.rule for diagnostic in found if diagnostic.rule != "not-generated"]

    assert said() == said() == []
    assert len(resolved) == 1
    match change:
        case "module":
            Path("out/robot/robot/arm.py").write_text("no Python")
            expected = "user-module"
        case "new module":
            Path("out/robot/robot/arm.py").unlink()
            assert said() == []
            Path("out/robot/robot/arm.py").write_text("no Python")
            expected = "user-module"
        case "package.xml":
            (workspace / "top_msgs/package.xml").write_text("<package><name>top_msgs</name></package>")
            expected = "undeclared-dependency"
        case "CMakeLists.txt":
            (workspace / "base_msgs/CMakeLists.txt").write_text("project(base_msgs)")
            expected = "no-interface-list"
        case _:
            (between / "package.xml").write_text("<package><name>in_between</name></package>")
            expected = "undeclared-dependency"
    assert said() == said() == [expected]


def test_a_module_saved_while_it_is_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    ifgen.generate("ws", output="out")
    original = ResolvedInput.diagnostics

    def save_meanwhile(resolved: ResolvedInput) -> object:
        found = original(resolved)
        Path("out/robot/robot/arm.py").write_text("no Python")
        return found

    with monkeypatch.context() as patched:
        patched.setattr(ResolvedInput, "diagnostics", save_meanwhile)
        Path("ws/top_msgs/msg/Alone.msg").write_text("int64 n\n")
        assert not ifgen.generate("ws", output="out").diagnostics
    assert [found.rule for found in ifgen.generate("ws", output="out").diagnostics] == ["user-module"]


def test_warnings_from_elsewhere(
    resolved: list[str], workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Paths are shown relative to the working directory of the run."""
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 class\n")
    Path("sub").mkdir()

    def said(back: str) -> str:
        return CliRunner().invoke(main.commands, ["generate", f"{back}ws", "-o", f"{back}out"]).stderr

    here = said("")
    monkeypatch.chdir("sub")
    there = said("../")
    assert "--> ws/top_msgs" in here and "ws/top_msgs/msg/Alone.msg:1:7" in there and here != there
    resolved.clear()
    assert said("../") == there
    monkeypatch.chdir("..")
    assert said("") == here and resolved == []


def test_broken_notes_of_runs_cost_time_only(resolved: list[str], tmp_path: Path, workspace: Path) -> None:
    (workspace / "top_msgs/msg/Alone.msg").write_text("int32 class\n")
    [first] = ifgen.generate("ws", output="out").diagnostics
    [notes] = (tmp_path / "cache/ifgen/generated").iterdir()
    document = json.loads(notes.read_text())
    [(key, (inputs, said))] = document["runs"].items()
    broken: tuple[object, ...] = (
        [],
        1,
        [inputs],
        [inputs, 1],
        [inputs, {}],
        [inputs, said | {"files": []}],
        [inputs, {"files": 1, "found": 2}],
    )
    for run in broken:
        resolved.clear()
        notes.write_text(json.dumps(document | {"runs": {key: run}}))
        assert ifgen.generate("ws", output="out").diagnostics == (first,)
        assert resolved == ["read"]
