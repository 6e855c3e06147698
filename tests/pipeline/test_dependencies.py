"""Dependencies that are generated, that are reported as missing, and that remain from earlier runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import ifgen.pipeline.stages
import pytest
from ifgen.diagnostics import UsageError
from ifgen.pipeline.model import load_model
from ifgen.reading.search_path import WithDeps

FILES = {
    "src/top_msgs/msg/Top.msg": "own_msgs/Own own\nstd_msgs/String text\n",
    "libs/own_msgs/msg/Own.msg": "far_msgs/Far far\ngeometry_msgs/Point point\n",
    "libs/own_msgs/msg/Other.msg": "int8 a\n",
    "libs/far_msgs/msg/Far.msg": "int8 a\n",
    "libs/unused_msgs/msg/Unused.msg": "int8 a\n",
    "other/other_msgs/msg/Other.msg": "std_msgs/Header header\n",
}


@pytest.fixture(autouse=True)
def workspace(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def generate(*paths: str, with_deps: WithDeps = False) -> tuple[set[str], list[str]]:
    """The packages in the output folder, and the diagnostics."""
    done = ifgen.generate(*(paths or ("src",)), output="out", include=["libs"], with_deps=with_deps)
    drift = ifgen.pipeline.stages.drift(
        *(paths or ("src",)), output="out", include=["libs"], with_deps=with_deps
    )
    assert not drift.drifts
    assert [found.message for found in drift.diagnostics] == [found.message for found in done.diagnostics]
    return packages(), [found.message for found in done.diagnostics]


def packages() -> set[str]:
    return {path.name for path in Path("out").iterdir()}


def test_own_dependencies_are_those_that_are_found_in_the_folders_to_include() -> None:
    own = {"top_msgs", "own_msgs", "far_msgs"}
    assert generate(with_deps="own") == (own, [])
    assert Path("out/own_msgs/msg/_other.py").is_file(), "they are written whole"
    everything, said = generate(with_deps=True)
    assert everything == own | {"std_msgs", "geometry_msgs", "builtin_interfaces"}
    assert not said


def test_what_nothing_provides_at_run_time_is_said() -> None:
    missing = "nothing provides package '{}' at run time: it is needed, but not generated"
    assert generate() == ({"top_msgs"}, [missing.format("far_msgs"), missing.format("own_msgs")])
    assert generate("src", "libs/own_msgs")[1] == [missing.format("far_msgs")]
    assert generate("libs/far_msgs")[1] == []
    assert generate("src")[1] == [], "both are in the output folder by now"


def test_a_program_runs_on_own_dependencies() -> None:
    generate(with_deps="own")
    program = "import ifgen; ifgen.activate('local', 'out'); from top_msgs.msg import Top; print(Top())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_dependencies_that_nothing_generates_any_more_are_removed() -> None:
    generate(with_deps=True)
    assert generate(with_deps="own")[0] == {"top_msgs", "own_msgs", "far_msgs"}
    assert generate()[0] == {"top_msgs"}
    generate("libs/far_msgs", with_deps=True)
    assert generate()[0] == {"top_msgs", "far_msgs"}, "asked for in its own right"


def test_dependencies_of_others_stay() -> None:
    """A run that is not about all packages in the output folder does not know what those need."""
    generate(with_deps=True)
    before = packages()
    assert generate("other")[0] == {*before, "other_msgs"}
    assert generate()[0] == {*before, "other_msgs"}
    assert generate("src", "other")[0] == {"top_msgs", "other_msgs"}


def test_edited_dependencies_stay() -> None:
    generate(with_deps="own")
    Path("out/far_msgs/msg/_far.py").write_text("# mine\n")
    done = ifgen.generate("src", output="out", include=["libs"])
    assert [path.name for path in done.kept] == ["_far.py"]
    assert packages() == {"top_msgs", "far_msgs"}


@pytest.mark.parametrize("output", ["src", "src/../src"])
def test_a_package_is_not_generated_into_its_own_source(output: str) -> None:
    for run in (ifgen.generate, ifgen.pipeline.stages.drift):
        with pytest.raises(UsageError, match="into its own source"):
            run("src", output=output, include=["libs"])
    assert not list(Path("src").rglob("*.py"))


def test_generating_again_with_the_output_among_the_paths(workspace: Path) -> None:
    nodes = workspace / "src/nodes/nodl/talker.nodl.yaml"
    nodes.parent.mkdir(parents=True)
    nodes.write_text("nodl_version: 2\n")
    first = ifgen.generate(".", output="generated")
    assert first.written
    again = ifgen.generate(".", output="generated")
    assert (again.written, again.removed) == ((), ())


@pytest.mark.parametrize("file", ["msg/A.msg", "srv/A.srv", "action/A.action"])
def test_what_a_single_file_needs_of_its_own_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (
        "B b\n" if file.startswith("msg") else "B b\n---\n" if file.startswith("srv") else "B b\n---\n---\n"
    )
    for path, content in {file: text, "msg/B.msg": "C[2] c\n", "msg/C.msg": "int8 x\n"}.items():
        place = tmp_path / "a_msgs" / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(content)
    for with_deps in (False, True):
        types = {of.type_name for of in load_model(f"a_msgs/{file}", with_deps=with_deps).types}
        assert {"a_msgs/msg/B", "a_msgs/msg/C"} <= types
    assert ifgen.pipeline.stages.generate(f"a_msgs/{file}", output="out", with_deps=True).written
