"""Every single edit of the bundled interfaces is named in the right category, and nothing else is.

The categories are judged by running the classes of both versions, see judge.py.
"""

from __future__ import annotations

import json
import random
import shutil
from collections.abc import Sequence
from pathlib import Path

import ifgen as toolkit
import pytest
from ifgen.cli import main
from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import type_hash

from tests.codec.support import generate

from .corpus import Edit, Line, edits, messages
from .judge import Version, broken

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "edited_msgs"


@pytest.fixture(scope="module")
def bundled() -> Registry:
    return toolkit.load(ROOT / "interfaces")


def all_edits(bundled: Registry) -> list[Edit]:
    """Each edit of each definition, the same ones in each run."""
    chance = random.Random(14)
    return [edit for message in messages(bundled) for edit in edits(message, chance)]


def test_each_of_some_edits_is_named(
    bundled: Registry, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    of_rules: dict[str | None, list[Edit]] = {}
    for edit in all_edits(bundled):
        of_rules.setdefault(edit.rule, []).append(edit)
    chance = random.Random(15)
    some = [chance.choice(found) for found in of_rules.values()]
    check(some, tmp_path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(16))
def test_each_edit_is_named(
    part: int, bundled: Registry, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    check(all_edits(bundled)[part::16], tmp_path, capsys)


def test_nested_edits_are_named_by_their_path(
    bundled: Registry,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    edits_of_rules = [edit for edit in all_edits(bundled) if edit.rule is not None]
    corpus = random.Random(16).sample(edits_of_rules, 60)
    for number, edit in enumerate(corpus):
        for version, definition in (("old", edit.before), ("new", edit.after)):
            write(tmp_path / version / PACKAGE / f"msg/E{number}.msg", definition)
            held = [Line("bool", "flag"), Line(f"{PACKAGE}/E{number}[]", "held")]
            write(tmp_path / version / f"outer_msgs/msg/E{number}.msg", held)
    monkeypatch.chdir(tmp_path / "new")
    _, own = reported(Path(PACKAGE), Path("../old"), "source", capsys)
    _, through = reported(Path("outer_msgs"), Path("../old"), "source", capsys, "-I", PACKAGE)
    assert through == own
    assert through.keys() == {f"E{number}" for number in range(len(corpus))}
    old, new = (
        toolkit.load(tmp_path / version / "outer_msgs", include=[tmp_path / version / PACKAGE])
        for version in ("old", "new")
    )
    for name, found in through.items():
        hashes = {type_hash(known.interface(f"outer_msgs/msg/{name}"), known) for known in (old, new)}
        assert any("hash" in breaks for _, breaks in found) == (len(hashes) == 2), name


def test_nothing_is_reported_of_comments_blanks_and_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """All bundled interfaces and nodes, with other comments, and in other folders."""
    for package in (ROOT / "interfaces").iterdir():
        shutil.copytree(package, tmp_path / package.name[::-1] / package.name, symlinks=True)
    for path in tmp_path.rglob("*.*"):
        if path.suffix in {".msg", ".srv", ".action"}:
            text = path.read_text().replace("\n---\n", "\n\n---\n# and then\n")
            path.write_text(f"# A comment.\n\n{text}\n  \n# The end.\n")
    assert reported(tmp_path, ROOT / "interfaces", "source", capsys) == (0, {})


def check(corpus: Sequence[Edit], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each edit is of a message of its own, and all of them are reported in one run."""
    old, new = folder / "old" / PACKAGE, folder / "new" / PACKAGE
    for number, edit in enumerate(corpus):
        write(old / f"msg/E{number}.msg", edit.before)
        write(new / f"msg/E{number}.msg", edit.after)
    once: dict[str, int] = {}  # a definition before has many edits, and only one class
    numbers = [once.setdefault("".join(map(str, edit.before)), len(once)) for edit in corpus]
    for number, edit in zip(numbers, corpus, strict=True):
        write(folder / "once" / PACKAGE / f"msg/E{number}.msg", edit.before)
    classes = generate(folder / "old_classes", folder / "once" / PACKAGE)
    others = generate(folder / "new_classes", new)
    before, after = toolkit.load(old), toolkit.load(new)
    judged: dict[str, set[str]] = {}
    for number, edit in enumerate(corpus):
        name = f"{PACKAGE}/msg/E{number}"
        judged[f"E{number}"] = broken(
            Version(classes[f"{PACKAGE}/msg/E{numbers[number]}"], name, classes, before),
            Version(others[name], name, others, after),
            edit.renamed,
        )
        assert judged[f"E{number}"] or edit.rule is None, edit
    code, found = reported(new, old, "source", capsys)
    assert code == 1
    for number, edit in enumerate(corpus):
        of_edit = found.get(f"E{number}", [])
        assert set().union(*(breaks for _, breaks in of_edit)) == judged[f"E{number}"], (edit, of_edit)
        # A class may lose the enumeration of its constants besides, by almost any edit.
        assert {rule for rule, _ in of_edit} - {"enum-members"} == {edit.rule} - {None}, (edit, of_edit)
    assert found.keys() <= judged.keys()
    for category, promised in (("hash", {"hash", "wire"}), ("wire", {"wire"})):
        code, fewer = reported(new, old, category, capsys)
        assert code == 1
        assert fewer.keys() == {name for name, breaks in judged.items() if breaks & promised}


def write(path: Path, definition: Sequence[Line]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(map(str, definition)))


def reported(
    new: Path, old: Path, category: str, capsys: pytest.CaptureFixture[str], *options: str
) -> tuple[int, dict[str, list[tuple[str, set[str]]]]]:
    """The exit code, and the rules and categories that are reported of each file."""
    capsys.readouterr()
    words = (
        "breaking",
        str(new),
        "--against",
        str(old),
        "--category",
        category,
        "--format",
        "json",
        *options,
    )
    code = main.main(words)
    found: dict[str, list[tuple[str, set[str]]]] = {}
    for diagnostic in json.loads(capsys.readouterr().out)["diagnostics"]:
        assert diagnostic["severity"] == "error"
        name = Path(diagnostic["labels"][0]["path"]).stem
        found.setdefault(name, []).append((diagnostic["rule"], set(diagnostic["breaks"])))
    return code, found
