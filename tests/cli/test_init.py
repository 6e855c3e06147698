"""`ifgen init`: its additions to the files of a project, and that nothing else in them changes."""

from __future__ import annotations

import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from ifgen.cli import project_files
from ifgen.diagnostics import UsageError

from .conftest import Outcome, Run, write

ATTRIBUTES = "generated/** text=auto eol=lf linguist-generated\ngenerated/*/*/[!_]*.py -linguist-generated\n"
HOOKS = """\
repos:
  - repo: https://github.com/ifgen-ros/ifgen
    rev: v0.1.0
    hooks:
      - id: ifgen-check
      - id: ifgen-generate
"""


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def git(folder: Path, *words: str) -> str:
    return subprocess.run(["git", *words], cwd=folder, capture_output=True, text=True, check=True).stdout


def test_from_nothing(ifgen: Run, tmp_path: Path) -> None:
    done = ifgen("init", "--github", "--pre-commit")
    assert done == Outcome(
        0,
        "wrote pyproject.toml\nwrote .gitattributes\nwrote .github/workflows/ifgen.yml\n"
        "wrote .pre-commit-config.yaml\n"
        "next: `ifgen new interface demo_msgs/msg/Name`, then `ifgen generate`\n",
        "",
    )
    assert (
        tmp_path / "pyproject.toml"
    ).read_text() == '[tool.ifgen]\npaths = ["interfaces"]\noutput = "generated"\n'
    assert (tmp_path / ".gitattributes").read_text() == ATTRIBUTES
    assert (tmp_path / ".pre-commit-config.yaml").read_text() == HOOKS
    assert "`ifgen new interface demo_msgs/msg/Name` makes it" in ifgen("generate").err
    assert ifgen("new", "interface", "demo_msgs/msg/Name").code == 0, "interfaces/ is still to come"
    assert ifgen("generate").code == 0
    assert ifgen("generate", "--check").code == 0


def test_again_it_changes_nothing(ifgen: Run, tmp_path: Path) -> None:
    ifgen("init", "--github", "--pre-commit")
    before = contents(tmp_path)
    done = ifgen("init", "--github", "--pre-commit")
    assert (done.code, done.err) == (0, "")
    assert done.out.count("nothing to add\n") == len(done.out.splitlines()) == 4
    assert contents(tmp_path) == before
    (tmp_path / ".gitattributes").unlink()
    assert (
        ifgen("init").out
        == "pyproject.toml: nothing to add\nwrote .gitattributes\nnext: `ifgen new interface demo_msgs/msg/Name`, then `ifgen generate`\n"
    )


def test_dry_run(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "pyproject.toml", "[project]\n")
    done = ifgen("init", "--dry-run", "--github", "--pre-commit")
    assert done.code == 0
    for line in (
        "--- pyproject.toml\n",
        "\n+[tool.ifgen]\n",
        "--- /dev/null\n+++ .gitattributes\n",
        "\n+      - id: ifgen-check\n",
        "\n+name: ifgen\n",
    ):
        assert line in done.out
    assert list(contents(tmp_path)) == ["pyproject.toml"]


@pytest.mark.parametrize(
    ("packages", "paths"),
    [
        ([], ["interfaces"]),
        (["interfaces/a_msgs"], ["interfaces"]),
        (["src/repo/a_msgs", "src/b_msgs", "more/c_msgs"], ["more", "src"]),
        (["a_msgs", "b_msgs"], ["a_msgs", "b_msgs"]),
        (["a", "b", "c", "d", "e"], ["."]),
        (["."], ["."]),
        (["venv/share/std_msgs", "src/a_msgs"], ["src"]),
        (["build/a_msgs", ".hidden/b_msgs"], ["interfaces"]),
    ],
)
def test_where_packages_are(ifgen: Run, tmp_path: Path, packages: list[str], paths: list[str]) -> None:
    for package in packages:
        write(tmp_path / package / "msg/A.msg", "int32 x\n")
    if any("venv" in package for package in packages):
        write(tmp_path / "venv/pyvenv.cfg", "")
    assert ifgen("init").code == 0
    assert tomllib.loads((tmp_path / "pyproject.toml").read_text()) == {
        "tool": {"ifgen": {"paths": paths, "output": "generated"}}
    }
    if packages and paths != ["interfaces"]:
        assert ifgen("generate").code == 0


def test_what_is_asked_for(ifgen: Run, tmp_path: Path) -> None:
    """Names that TOML, git and YAML need quotes for."""
    git(tmp_path, "init", "-q")
    folder = tmp_path / 'a "robot"\'s'
    write(folder / "messages é/a_msgs/msg/A.msg", "int32 x\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert ifgen("init", "messages é", "-o", "out [1]/x*", "--github").code == 0
        assert ifgen("generate").code == 0
    assert (folder / "out [1]/x*/a_msgs/msg/_a.py").exists()
    name = 'a "robot"\'s/out [1]/x*/a_msgs/msg/_a.py'
    told = git(
        tmp_path, "-c", "core.quotePath=false", "check-attr", "-z", "eol", "linguist-generated", "--", name
    )
    assert told.split("\0")[2::3] == ["lf", "set"]
    assert git(tmp_path, "check-attr", "eol", "--", 'a "robot"\'s/out 1/xy/a.py').endswith("unspecified\n")
    workflow = yaml.safe_load((tmp_path / ".github/workflows/ifgen.yml").read_text())
    assert workflow["jobs"]["ifgen"]["steps"][1]["with"] == {
        "working-directory": 'a "robot"\'s',
        "generated": "out [1]/x*",
    }


def test_reviews_see_your_modules(ifgen: Run, tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    ifgen("init")
    ifgen("new", "node", "walker")
    assert ifgen("generate").code == 0
    attributes = {
        name: git(tmp_path, "check-attr", "linguist-generated", "--", name).split()[-1]
        for name in git(tmp_path, "ls-files", "-o", "generated").split()
    }
    folded = {name for name, value in attributes.items() if value == "set"}
    assert "generated/walker/walker/_walker_base.py" in folded
    assert "generated/walker/setup.py" in folded
    assert folded.isdisjoint({"generated/walker/walker/walker.py", "generated/walker/test/test_walker.py"})


@pytest.mark.parametrize(
    "text",
    [
        "",
        "# nothing",
        '[project]\nname = "x"  # no line end',
        "[tool.black]\r\nline-length = 100\r\n",
        "tool.black.line-length = 100\n",
        "[[tool.x]]\na = 1\n",
        '[tool]\nx = """\n[tool.ifgen]\n"""\n',
    ],
)
def test_what_is_in_pyproject_stays(ifgen: Run, tmp_path: Path, text: str) -> None:
    file = tmp_path / "pyproject.toml"
    file.write_bytes(text.encode())
    assert ifgen("init").code == 0
    changed = file.read_bytes().decode()
    assert changed.startswith(text)
    assert ("\r\n" in changed[len(text) :]) == ("\r\n" in text)
    before, after = tomllib.loads(text), tomllib.loads(changed)
    assert after["tool"].pop("ifgen") == {"paths": ["interfaces"], "output": "generated"}
    assert after == {"tool": {}, **before}


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("pyproject.toml", "[tool\n", "pyproject.toml is not valid TOML"),
        ("pyproject.toml", "tool = {black = {}}\n", "add this by hand: [tool.ifgen] paths ="),
        ("pyproject.toml", "tool = 1\n", "add this by hand: [tool.ifgen] paths ="),
        ("pyproject.toml", "[tool.ifgen]\npath = 1\n", "did you mean 'paths'?"),
        (".pre-commit-config.yaml", "a: [\n", "not valid YAML"),
        (".pre-commit-config.yaml", "[" * 5000, "not valid YAML"),
        (".pre-commit-config.yaml", "x: 1\n", "has no list `repos`"),
        (".pre-commit-config.yaml", "- repo\n", "has no list `repos`"),
        (".pre-commit-config.yaml", "repos: [{repo: x}]\n", "add this by hand: - repo:"),
        (".pre-commit-config.yaml", "repos:\n  - &a {repo: x}\n  - *a\n", "add this by hand: - repo:"),
        (".pre-commit-config.yaml", "a: &a [x]\nrepos: *a\n", "add this by hand: - repo:"),
    ],
)
def test_what_cannot_be(ifgen: Run, tmp_path: Path, name: str, text: str, said: str) -> None:
    write(tmp_path / name, text)
    done = ifgen("init", "--github", "--pre-commit")
    assert done.code == 2
    assert said in " ".join(done.err.split())
    assert contents(tmp_path) == {name: text.encode()}


def test_files_that_cannot_be_read(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / ".gitattributes").write_bytes(b"\xff")
    done = ifgen("init")
    assert done.code == 1
    assert "not UTF-8" in done.err
    (tmp_path / ".gitattributes").unlink()
    (tmp_path / "pyproject.toml").mkdir()
    assert ifgen("init").code == 1
    assert not (tmp_path / ".gitattributes").exists()


def test_all_or_nothing(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path / ".github", "in the way")
    done = ifgen("init", "--github")
    assert done.code == 1
    assert done.err.startswith("error: ")
    assert list(contents(tmp_path)) == [".github"]


def test_what_is_configured_is_not_changed(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["src"]\noutput = "out"\n')
    for words in (["-o", "other"], ["."]):
        done = ifgen("init", *words)
        assert (done.code, "change `paths` and `output` there" in done.err) == (2, True)
    assert ifgen("init").code == 0
    assert (tmp_path / ".gitattributes").read_text() == ATTRIBUTES.replace("generated/", "out/")
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\noutput = "../out"\ntests = false\n')
    assert ifgen("init").out == "pyproject.toml: nothing to add\n", "attributes are for what is below"
    ifgen("init", "--github")
    assert (tmp_path / ".github/workflows/ifgen.yml").read_text().endswith('with:\n          generated: ""\n')


def test_sources_are_not_the_output(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "src/a_msgs/msg/A.msg", "int32 x\n")
    assert "cannot be both" in ifgen("init", "src", "-o", "src").err
    assert "cannot be both" in ifgen("init", ".", "-o", ".").err
    assert not (tmp_path / "pyproject.toml").exists()


def test_hooks_are_of_the_whole_repository(
    ifgen: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "robot").mkdir()
    monkeypatch.chdir(tmp_path / "robot")
    done = ifgen("init", "--pre-commit")
    assert (done.code, "run `ifgen init --pre-commit` there" in done.err) == (2, True)
    assert ifgen("init", "--github").code == 0
    assert (tmp_path / ".github/workflows/ifgen.yml").exists()


def test_links_stay(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "shared.toml", "[project]\n")
    (tmp_path / "pyproject.toml").symlink_to("shared.toml")
    assert ifgen("init").code == 0
    assert (tmp_path / "pyproject.toml").is_symlink()
    assert "[tool.ifgen]" in (tmp_path / "shared.toml").read_text()


ENTRY: dict[str, Any] = yaml.safe_load(HOOKS)["repos"][0]
CONFIGS = (
    "repos: []",
    "repos: []  # none yet\nci: {}\n",
    "# all of it\n",
    "repos:\n- repo: local\n  hooks:\n  - id: a\n    entry: |\n      x\n      y\n# more to come\nexclude: ^docs/\n",
    "exclude: x\nrepos:\n  -   repo: a\n      rev: '1'\n      hooks: [{id: b}]\n\n\n# end",
    "repos:\r\n  - repo: a\r\n    hooks:\r\n      - id: b  # here\r\nci:\r\n  skip: [b]\r\n",
    "---\nrepos:\n  - repo: a\n    hooks:\n      - id: b\n        args: [--x,\n          y]\n...\n",
    "repos:\n  - repo:\n",
    "repos:\n  - repo: >-\n      a\n      b",
)


@pytest.mark.parametrize("text", CONFIGS)
def test_hooks_are_added_to_others(text: str) -> None:
    changed = project_files.with_hooks(Path("x"), text, "v0.1.0")
    before, after = yaml.safe_load(text) or {}, yaml.safe_load(changed)
    assert after.pop("repos") == [*before.pop("repos", []), ENTRY]
    assert after == before
    assert [line for line in text.splitlines() if "#" in line] == [
        line for line in changed.splitlines() if "#" in line
    ] or "[]" in text
    assert ("\r\n" in changed) == ("\r\n" in text)
    assert changed.count("\r\n") in {0, changed.count("\n")}
    assert project_files.with_hooks(Path("x"), changed, "v0.1.0") == changed


LINES = st.lists(
    st.sampled_from(
        [
            "repos:",
            "  - repo: a",
            "- repo: b",
            "    hooks: []",
            "repos: []",
            "  ",
            "# x",
            "ci:",
            "  x: |",
            "    y",
            "a: b",
            "...",
            "---",
            "  - *a",
            "&a",
            "\t",
            '"',
            "[",
            "]",
        ]
    ),
    max_size=8,
)


@given(LINES, st.sampled_from(["\n", "\r\n"]), st.booleans())
def test_any_text_is_added_to_or_refused(lines: list[str], line_end: str, is_ended: bool) -> None:
    text = line_end.join(lines) + line_end * is_ended
    try:
        changed = project_files.with_hooks(Path("x"), text, "v0.1.0")
    except UsageError:
        return
    before, after = yaml.safe_load(text) or {}, yaml.safe_load(changed)
    assert after.pop("repos") == [*before.pop("repos", []), ENTRY]
    assert after == before
