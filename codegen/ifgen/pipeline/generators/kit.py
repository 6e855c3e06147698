"""The kit for authors of generators: a corpus of interfaces with every trap, and what must hold for each.

The same input gives the same files, members of the model that nobody knows change nothing, and files are as
a folder of golden ones has them.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import unified_diff
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, cast

from ifgen import generators as public
from ifgen.config.customization import Customization, Output, Target
from ifgen.diagnostics import Diagnostic, InputError, printable, shorten
from ifgen.generators import protocol
from ifgen.pipeline.generators import find
from ifgen.pipeline.generators.programs import failure
from ifgen.pipeline.generators.run import run_targets
from ifgen.pipeline.model import BuiltModel, load_built_model
from ifgen.reading.storage import MAX_GENERATED, read_limited
from ifgen.writing import transaction

CORPUS: Final = Path(public.__file__).with_name("corpus.txt")
_HEAD: Final = re.compile(r"^==> (\S+) <==\n", re.MULTILINE)
_REPEATED: Final = re.compile(r"\* (\d+)\n(.*)", re.DOTALL)
_MOST_LINES: Final = 30
_MOST_FILES: Final = 3
"""The files of one kind of difference that are shown; the others are counted."""

_LONGEST_LINE: Final = 200
_ELSEWHERE: Final = "another locale, PYTHONHASHSEED, time zone or working directory makes other files"
_OTHER: Final = {
    **{"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    **{"PYTHONHASHSEED": "2718", "TZ": "Asia/Kathmandu"},
}
_CODE: Final = "import sys; from ifgen.pipeline.generators import kit; kit.make_elsewhere(*sys.argv[1:])"

Files = Mapping[str, str | bytes]


@dataclass(frozen=True, slots=True)
class Report:
    """The outcome of the kit: what it found wrong, in words, what the generator said, and its files."""

    problems: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    files: Files
    updated: int = 0


def corpus() -> dict[str, str]:
    """The files of the corpus, by path. A text that begins with `* N` is there N times, with numbers."""
    parts = _HEAD.split(CORPUS.read_text(encoding="utf-8"))[1:]
    return {path: _text(text) for path, text in zip(parts[::2], parts[1::2], strict=True)}


def _text(text: str) -> str:
    if match := _REPEATED.fullmatch(text):
        return "".join(match[2].replace("{}", str(number)) for number in range(int(match[1])))
    return text


def copy_of(original: str, name: str, module: str) -> dict[str, bytes]:
    """The files of an installed generator, as those of another name in another module.

    Raises InputError if there is none.
    """
    find.named(original)
    package = find.installed()[original].module
    [*_, place] = find.sources(Target(name, Path(), use=original))
    paths = [place] if place.is_file() else sorted(place.rglob("*"))
    found: dict[str, bytes] = {}
    for path in paths:
        if path.is_file() and "__pycache__" not in path.parts:
            inside = "__init__.py" if path == place else path.relative_to(place).as_posix()
            data = path.read_bytes()
            if path.suffix == ".py":
                text = re.sub(rf"\b{re.escape(package)}\b", module, data.decode())
                data = re.sub(rf"""\bname=(["']){re.escape(original)}\1""", f'name="{name}"', text).encode()
            found[inside] = data
    return found


def write_corpus(folder: Path) -> None:
    """Write the corpus into a folder, for tools that compile what a generator makes of it."""
    transaction.apply([(folder / path, text.encode()) for path, text in corpus().items()], folder)


def test(target: Target, golden: Path | None = None, *, update: bool = False) -> Report:
    """Run a generator on the corpus. Raises InputError if it cannot be used at all."""
    with TemporaryDirectory(prefix="ifgen-corpus-") as name:
        folder = Path(name)
        write_corpus(folder)
        built = load_built_model(folder, with_deps=False)
        target = replace(target, unsupported="skip", out=folder / "out")
        generator = find.find(target)  # whose errors are about all of it
        try:
            files, diagnostics = _files(target, built)
        except InputError as error:
            return Report(("it refuses the corpus",), error.diagnostics, {})
        diagnostics = (*diagnostics, *_about_templates(generator))
        problems = [*_unequal(files, _files(target, built)[0], "a second run makes other files")]
        problems += _unequal(files, _made_elsewhere(target, folder), _ELSEWHERE)
        if target.command:
            problems += _with_unknown_members(target, built, files)
        if not files:
            problems.append("it makes no files")
        problems += _plain_texts(files)
    updated = 0
    if golden is not None:
        if update:
            updated = _update(golden, files)
        else:
            problems += _unequal(_read(golden), files, f"not as in {golden}; --update accepts it")
    return Report(tuple(problems), diagnostics, files, updated)


def _about_templates(generator: public.Generator) -> Iterator[Diagnostic]:
    """The warnings about the templates of a set. Errors have stopped it already."""
    if generator.templates is not None:
        from ifgen.generator_py.templates.render import look_for_problems  # jinja2 takes long to load

        outputs = tuple(Output(of.template, of.template, of.path, of.per) for of in generator.outputs)
        yield from look_for_problems(Customization(generator.templates, generator.filters, outputs))


def _files(target: Target, built: BuiltModel) -> tuple[Files, tuple[Diagnostic, ...]]:
    result = run_targets([target], built)
    return {name: of for folder in result.folders for name, of in folder.files.items()}, result.diagnostics


def make_elsewhere(use: str, command: str, options: str, base: str, output: str) -> None:
    """Run a generator on the corpus, as `test` asks another process to, and write what it makes."""
    words = tuple(json.loads(command))
    with TemporaryDirectory(prefix="ifgen-corpus-") as name:
        folder = Path(name)
        write_corpus(folder)
        target = Target(
            "test",
            folder / "out",
            use or None,
            words,
            json.loads(options),
            unsupported="skip",
            base=Path(base),
        )
        try:
            files, _ = _files(target, load_built_model(folder, with_deps=False))
        except InputError as error:
            raise SystemExit("\n".join(of.message for of in error.diagnostics)) from None
        _update(Path(output), files)


def _made_elsewhere(target: Target, folder: Path) -> Files:
    """The files of another process, in whose environment everything is different that must not matter."""
    cwd, output = folder / "elsewhere", folder / "made"
    cwd.mkdir()
    words = [json.dumps(target.command), json.dumps(target.options), str(target.base.absolute()), str(output)]
    environment = {**os.environ, **_OTHER, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    command = [sys.executable, "-c", _CODE, target.use or "", *words]
    done = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, errors="replace", check=False
    )
    if done.returncode:
        raise InputError([failure(None, f"{_ELSEWHERE}: it fails", printable(done.stderr).strip()[-1000:])])
    return _read(output)


def _with_unknown_members(target: Target, built: BuiltModel, files: Files) -> Iterator[str]:
    """The differences that a later version of the model makes to a program."""

    def later(request: public.Request) -> str:
        return json.dumps(_with_more(json.loads(protocol.generate_request(request))))

    again = run_targets([target], built, later)
    found = {name: of for folder in again.folders for name, of in folder.files.items()}
    yield from _unequal(files, found, "unknown members of the model change its files")


def _with_more(value: Any) -> Any:
    if isinstance(value, dict):
        table = cast("dict[str, Any]", value)
        members = {key: _with_more(of) for key, of in table.items()}
        # Descriptions are ROS's own.
        return members if "type_description" in table else {"x_later": ["?"], **members}
    if isinstance(value, list):
        return [_with_more(of) for of in cast("Iterable[Any]", value)]
    return value


def _plain_texts(files: Files) -> Iterator[str]:
    for name, content in files.items():
        if isinstance(content, str) and "\r" in content:
            yield f"{name} has line ends of Windows"


def _unequal(expected: Files, found: Files, why: str) -> Iterator[str]:
    different = [
        name
        for name in sorted(expected.keys() | found.keys())
        if _shown(expected.get(name)) != _shown(found.get(name))
    ]
    for name in different[:_MOST_FILES]:
        before, after = _shown(expected.get(name)), _shown(found.get(name))
        if before is None or after is None:
            yield f"{name} is {'new' if before is None else 'gone'}: {why}"
        else:
            lines = list(unified_diff(before.splitlines(), after.splitlines(), name, name, lineterm=""))
            more = [f"... {len(lines) - _MOST_LINES} more lines"] if len(lines) > _MOST_LINES else []
            shown = (shorten(line, _LONGEST_LINE) for line in lines[:_MOST_LINES])
            yield "\n".join([f"{name}: {why}", *shown, *more])
    if len(different) > _MOST_FILES:
        yield f"... and {len(different) - _MOST_FILES} more: {why}"


def _shown(content: str | bytes | None) -> str | None:
    return content if isinstance(content, str) or content is None else repr(content)


def _read(golden: Path) -> dict[str, str | bytes]:
    found: dict[str, str | bytes] = {}
    for path in sorted(golden.rglob("*")):
        if path.is_file():
            data = read_limited(path, MAX_GENERATED)
            try:
                found[path.relative_to(golden).as_posix()] = data.decode()
            except UnicodeDecodeError:
                found[path.relative_to(golden).as_posix()] = data
    return found


def _update(golden: Path, files: Files) -> int:
    golden.mkdir(parents=True, exist_ok=True)
    before = _read(golden)
    changes: list[transaction.Change] = [(golden / name, None) for name in before.keys() - files.keys()]
    for name, content in files.items():
        if before.get(name) != content:
            changes.append((golden / name, content.encode() if isinstance(content, str) else content))
    transaction.apply(changes, golden)
    return len(changes)
