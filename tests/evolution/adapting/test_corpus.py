"""For every single edit of the bundled interfaces, the adapter has a hole exactly where a value may be lost."""

from __future__ import annotations

import contextlib
import random
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import ifgen as toolkit
import pytest
from ifgen.cli import main
from ifgen.definition.interfaces import Registry
from ifgen_runtime.adapters import decode
from ifgen_runtime.codec import deserialize, serialize
from ifgen_runtime.errors import CodecError

from tests.evolution.corpus import Edit, Line, edits, messages
from tests.runtime.support import imported_from

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = "edited_msgs"
OPEN = re.compile(r"^        (\w+)=undecided\($|^    lost\(\n        (?:old|new)\.(\w+),$", re.MULTILINE)

RANGES = {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
EXACT = {"float32": 2**24, "float64": 2**53}


@pytest.fixture(scope="module")
def bundled() -> Registry:
    return toolkit.load(ROOT / "interfaces")


def corpus(bundled: Registry) -> list[Edit]:
    chance = random.Random(14)
    return [edit for message in messages(bundled) for edit in edits(message, chance)]


def test_each_of_some_edits_is_adapted(
    bundled: Registry, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    of_rules: dict[str | None, list[Edit]] = {}
    for edit in corpus(bundled):
        of_rules.setdefault(edit.rule, []).append(edit)
    chance = random.Random(15)
    some = [chance.choice(found) for found in of_rules.values()]
    check(some, tmp_path, monkeypatch, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_more_edits_are_adapted_and_typed(
    part: int, bundled: Registry, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    edits = random.Random(16 + part).sample(corpus(bundled), 150)
    folder = check(edits, tmp_path, monkeypatch, capsys)
    expected = {
        f"{path.name}:{text[: match.start()].count(chr(10)) + 1 + (match[1] is None)}"
        for path in folder.glob("e*.py")
        for text in [path.read_text()]
        for match in OPEN.finditer(text)
    }
    (tmp_path / "mypy.ini").write_text("[mypy]\n")
    search = [tmp_path / "generated", ROOT / "generated", ROOT / "codegen", ROOT / "codegen/underlay"]
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "mypy.ini", "-p", "adapters"]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={"MYPYPATH": ":".join(map(str, search)), "PATH": ""},
        timeout=600,
        check=False,
    )
    found = re.findall(r"^adapters/(\S+?:\d+): error: ", done.stdout, re.MULTILINE)
    assert set(found) == expected, done.stdout + done.stderr


def check(corpus: Sequence[Edit], folder: Path, monkeypatch: Any, capsys: Any) -> Path:
    """Each edit is of a message of its own; returns the folder of their adapters."""
    old, new = folder / "old" / PACKAGE, folder / "new" / PACKAGE
    for number, edit in enumerate(corpus):
        for package, lines in ((old, edit.before), (new, edit.after)):
            path = package / f"msg/E{number}.msg"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("".join(map(str, lines)))
    (folder / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["new"]\n')
    monkeypatch.chdir(folder)
    toolkit.generate(new, output=folder / "generated")
    adapted: list[tuple[int, Edit]] = []
    for number, edit in enumerate(corpus):
        code = main.main(["adapt", f"{PACKAGE}/msg/E{number}", "--from", str(folder / "old"), "--downgrade"])
        said = capsys.readouterr()
        if code:
            assert "nothing to adapt" in said.err
            assert edit.rule not in {"field-added", "field-removed", "field-renamed", "field-type"}, edit
        else:
            adapted.append((number, edit))
    adapters = folder / "adapters"
    shutil.copy(ROOT / "LICENSE", folder)  # something beside them that is no adapter
    with imported_from(folder, ("adapters",)), imported_from(ROOT / "generated", _packages()):
        sys.path.insert(0, str(folder / "generated"))
        try:
            for number, edit in adapted:
                [path] = adapters.glob(f"e{number}_*.py")
                _check_module(import_module(f"adapters.{path.stem}"), path.read_text(), edit)
        finally:
            sys.path.remove(str(folder / "generated"))
            for name in [name for name in sys.modules if name.partition(".")[0] == PACKAGE]:
                del sys.modules[name]
    return adapters


def _packages() -> list[str]:
    return [path.name for path in (ROOT / "generated").iterdir()]


def _check_module(module: ModuleType, text: str, edit: Edit) -> None:
    upgrade, _, _ = text.partition("\ndef downgrade(")
    holes = sorted(name or lost for name, lost in OPEN.findall(upgrade))
    assert holes == sorted(expected_holes(edit)), (edit, text)
    if holes:
        return
    adapter = next(value for name, value in vars(module).items() if re.fullmatch(r"E\d+_[0-9a-f]{8}", name))
    new = next(value for name, value in vars(module).items() if re.fullmatch(r"E\d+", name))
    recorded = _recorded(module)
    old = deserialize(recorded, adapter)
    made = decode(recorded, adapter.__type_hash__, new)
    serialize(made)
    back = {after: before for before, after in edit.renamed.items()}
    before = {line.name: line for line in edit.before if not line.constant}
    for line in edit.after:
        if not line.constant and (known := before.get(back.get(line.name, line.name))):
            assert same(_value(old, known.name), _value(made, line.name)), (edit, line)
    chance = random.Random(17)
    for _ in range(20):
        damaged = bytearray(recorded)
        damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        del damaged[chance.randrange(4, len(damaged) + 1) :]
        with contextlib.suppress(CodecError):
            decode(bytes(damaged), adapter.__type_hash__, new)


def _value(message: Any, name: str) -> Any:
    return getattr(message, name, None) if hasattr(message, name) else getattr(message, f"{name}_")


def _recorded(module: ModuleType) -> bytes:
    """The bytes that the test beside a module has."""
    path = Path(str(module.__file__))
    test = path.with_name(f"test_adapt_{path.name}")
    if not test.exists():
        return serialize(next(v for n, v in vars(module).items() if "_" in n and isinstance(v, type))())
    digits = re.search(r"^RECORDED_MESSAGE = bytes.fromhex\(\n(.*?)^\)$", test.read_text(), re.M | re.S)
    assert digits
    return bytes.fromhex("".join(re.findall(r'"([0-9a-f]+)"', digits[1])))


def same(one: Any, other: Any) -> bool:
    """Whether two values are the same in both versions, a value and a sequence of it included."""
    if isinstance(one, bytes) != isinstance(other, bytes) and not hasattr(one, "__iter__"):
        return bool(bytes([one]) == other)
    if hasattr(other, "__len__") and not isinstance(other, str | bytes):
        items = list(one) if hasattr(one, "__len__") and not isinstance(one, str | bytes) else [one]
        return len(items) == len(other) and all(map(same, items, other))
    if isinstance(one, bytes) and not isinstance(other, bytes):
        return bool(one[0] == other)
    return bool(one == other)


def expected_holes(edit: Edit) -> list[str]:
    """The fields that a person has to decide on."""
    before = {line.name: line for line in edit.before if not line.constant}
    after = {line.name: line for line in edit.after if not line.constant}
    holes = [name for name in before if edit.renamed.get(name, name) not in after]
    for name, line in after.items():
        source = next((b for b in before.values() if edit.renamed.get(b.name, b.name) == name), None)
        if source is None:
            is_empty = line.value is not None or (line.type.endswith("]") and not line.type[-2].isdigit())
            if not is_empty and "[<=" not in line.type:
                holes.append(name)
        elif not fits(source, line):
            holes.append(name)
    return [name if name.isidentifier() and name != "from" else f"{name}_" for name in holes]


def fits(old: Line, new: Line) -> bool:
    """Whether each value of the old type is one of the new type, or makes one element of it."""
    (old_type, (least, most)), (new_type, (low, high)) = split(old.type), split(new.type)
    was_list, is_list = "[" in old.type, "[" in new.type
    if was_list and not is_list:
        return False
    return low <= least and most <= high and value_fits(old_type, new_type)


def split(type_: str) -> tuple[str, tuple[float, float]]:
    """The type of the elements, and the smallest and largest number of them."""
    base, bracket, size = type_.partition("[")
    size = size.removesuffix("]")
    if not bracket:
        return base, (1, 1)
    if size.startswith("<="):
        return base, (0, float(size[2:]))
    return base, (float(size), float(size)) if size else (0, float("inf"))


def value_fits(old: str, new: str) -> bool:
    old, new = ("uint8" if type_ == "char" else type_ for type_ in (old, new))
    if old == new:
        return True
    if {old, new} == {"byte", "uint8"} or (old, new) == ("float32", "float64"):
        return True
    texts = [re.fullmatch(r"w?string(?:<=(\d+))?", type_) for type_ in (old, new)]
    if texts[0] and texts[1]:
        bounds = [float(found[1] or "inf") for found in texts if found]
        return bounds[0] <= bounds[1]
    if old in RANGES and new in RANGES:
        return RANGES[new][0] <= RANGES[old][0] and RANGES[old][1] <= RANGES[new][1]
    return old in RANGES and new in EXACT and max(map(abs, RANGES[old])) <= EXACT[new]
