"""A second run does almost nothing, and never too little."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import ifgen
import pytest
from ifgen.diagnostics import InputError
from ifgen.pipeline import planning, stages
from ifgen.pipeline.cache import fingerprints
from ifgen.writing.write import OutputPackage


@pytest.fixture(autouse=True)
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for name, text in {
        "ws/base_msgs/msg/Base.msg": "int32 n\n",
        "ws/top_msgs/msg/Top.msg": "base_msgs/Base base\n",
        "ws/alone_msgs/msg/Alone.msg": "int32 n\n",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    return tmp_path / "cache/ifgen/generated"


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The packages that were rendered since it was last cleared."""
    names: list[str] = []
    original = planning.render

    def spy(*arguments: Any) -> Iterator[OutputPackage]:
        for package in original(*arguments):
            names.append(package.name)
            yield package

    monkeypatch.setattr(planning, "render", spy)
    return names


def generate(*paths: str, with_deps: bool = False) -> stages.Generated:
    return ifgen.generate(*(paths or ("ws",)), output="out", with_deps=with_deps)


def test_only_what_changed_is_rendered(rendered: list[str], tmp_path: Path) -> None:
    generate()
    assert sorted(rendered) == ["alone_msgs", "base_msgs", "top_msgs"]
    rendered.clear()
    assert len(generate().unchanged) == 15
    assert rendered == []
    (tmp_path / "ws/base_msgs/msg/Base.msg").write_text("int64 n\n")
    generate()
    assert sorted(rendered) == ["base_msgs", "top_msgs"], "top_msgs holds a Base"


IDL = "module base_msgs {{ module msg {{ struct Base {{ {} n; }}; }}; }};"


def test_idl_files_count(rendered: list[str], tmp_path: Path) -> None:
    """A definition that moves to an .idl file, changes there, or gets an additional .msg file."""
    generate()
    folder = tmp_path / "ws/base_msgs/msg"
    for number, text in enumerate((IDL.format("long"), IDL.format("double"))):
        rendered.clear()
        (folder / "Base.msg").unlink(missing_ok=True)
        (folder / "Base.idl").write_text(text)
        generate()
        assert sorted(rendered) == ["base_msgs", "top_msgs"], number
        rendered.clear()
        generate()
        assert rendered == []
    (folder / "Base.msg").write_text("int32 n\n")
    with pytest.raises(InputError, match=r"Base.msg and Base.idl define the same interface"):
        generate()
    (folder / "Base.idl").write_text("// generated from rosidl_adapter/\n" + IDL.format("double"))
    generate()
    assert "int32" in (tmp_path / "out/base_msgs/msg/_base.py").read_text()


def test_what_a_package_says_of_itself_counts(tmp_path: Path) -> None:
    """Warnings about package.xml or CMakeLists.txt are not forgotten."""
    (tmp_path / "ws/top_msgs/package.xml").write_text(
        "<package><name>top_msgs</name><depend>base_msgs</depend></package>"
    )
    assert not generate().diagnostics
    (tmp_path / "ws/top_msgs/package.xml").write_text("<package><name>top_msgs</name></package>")
    assert [found.rule for found in generate().diagnostics] == ["undeclared-dependency"]
    (tmp_path / "ws/alone_msgs/CMakeLists.txt").write_text("project(alone_msgs)")
    assert {found.rule for found in generate().diagnostics} == {"undeclared-dependency", "no-interface-list"}


def test_outputs_that_changed_are_rendered_again(rendered: list[str], tmp_path: Path) -> None:
    generate()
    for change in ("edit", "delete", "manifest"):
        rendered.clear()
        module = tmp_path / "out/top_msgs/msg/_top.py"
        before = module.read_text()
        match change:
            case "edit":
                module.write_text("edited")
            case "delete":
                module.unlink()
            case _:
                (tmp_path / "out/top_msgs/.ifgen-manifest.json").unlink()
        generate()
        assert rendered == ["top_msgs"], change
        assert module.read_text() == before


def test_dependencies_are_looked_at_too(rendered: list[str], tmp_path: Path) -> None:
    (tmp_path / "deps").mkdir()
    (tmp_path / "ws/base_msgs").rename(tmp_path / "deps/base_msgs")

    def run(with_deps: bool) -> list[str]:
        rendered.clear()
        ifgen.generate("ws/top_msgs", output="out", include=["deps"], with_deps=with_deps)
        return rendered

    assert run(False) == ["top_msgs"]
    assert run(False) == []
    assert run(True) == ["base_msgs"]
    assert run(True) == []
    (tmp_path / "deps/base_msgs/msg/More.msg").write_text("int32 n\n")
    assert run(True) == ["base_msgs"]
    assert (tmp_path / "out/base_msgs/msg/_more.py").exists()
    (tmp_path / "deps/base_msgs/msg/Base.msg").unlink()
    with pytest.raises(ifgen.InputError):
        run(False)


def test_a_file_saved_while_generating_is_not_missed(
    rendered: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "ws/alone_msgs/msg/Alone.msg"
    original = planning.render

    def render_slowly(*arguments: Any) -> Iterator[OutputPackage]:
        path.write_text("int64 saved_meanwhile\n")
        return original(*arguments)

    with monkeypatch.context() as patched:
        patched.setattr(planning, "render", render_slowly)
        generate()
    rendered.clear()
    generate()
    assert rendered == ["alone_msgs"]
    path.write_bytes(b"int64 saved_meanwhile\r\n")
    assert generate().written == ()


def test_another_ifgen_or_template_counts(
    rendered: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    generate()
    rendered.clear()
    monkeypatch.setattr(fingerprints, "of_generator", lambda templates: b"another")
    generate()
    assert len(rendered) == 3


@pytest.mark.parametrize(
    "text",
    [
        *("", "[]", "{", "{}", '{"packages": 1}', '{"packages": {}}', '{"packages": {"top_msgs": 1}}'),
        '{"packages": {"top_msgs": [[], [], "a"]}, "runs": {}}',
        '{"packages": {"top_msgs": [[], [], [], 1, "a", "b"]}, "runs": {}}',
        '{"packages": {"top_msgs": [[], [], [], {}, "a", "b"]}, "runs": 1}',
        '{"packages": {"top_msgs": [["a"], ["b"], [], {"c": 1}, 2, 3]}, "runs": {"a": 1}}',
    ],
)
def test_a_broken_cache_costs_time_only(rendered: list[str], cache: Path, text: str) -> None:
    generate()
    [note] = cache.iterdir()
    note.write_text(text)
    rendered.clear()
    assert generate().written == ()
    assert len(rendered) == 3
    rendered.clear()
    generate()
    assert rendered == []


def test_a_cache_that_cannot_be_written_costs_time_only(
    rendered: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    generate()
    assert generate().written == ()
    assert len(rendered) == 6
