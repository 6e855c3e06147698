"""New names for fields, constants, types and packages, wherever the workspace says the old ones."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from ifgen.definition import names
from ifgen.definition.resolve import Understood
from ifgen.diagnostics import Diagnostic, InputError, Source, Span, shown_path
from ifgen.evolution import version
from ifgen.evolution.compare import compare
from ifgen.evolution.edit_diagnostics import diagnostic
from ifgen.evolution.version import Version
from ifgen.language_server.buffers import Buffers
from ifgen.language_server.symbols import Symbol, interface_of, member_span
from ifgen.language_server.workspace import Workspace, members_of, parts_of
from ifgen.reading.manifest import is_generated
from ifgen.reading.packages import IDL, PackageFiles, find_what_can_be
from ifgen.reading.search_path import SearchPath

_MAX_PLACES: Final = 50
_TEXT_FILES: Final = (".j2", ".toml", ".yaml", ".yml", ".json", ".xml", ".launch")
_SKIPPED: Final = frozenset(("build", "install", "log", "node_modules"))


@dataclass(frozen=True, slots=True)
class Edit:
    """New text for a part of a file, in offsets of its text with plain line ends."""

    start: int
    end: int
    text: str


@dataclass
class Renaming:
    """All changes that a new name makes, and what they mean for others.

    `breaking` is what `ifgen breaking` says of the change. `python` are the places in Python that it breaks:
    they are never edited.
    """

    edits: dict[Path, dict[tuple[int, int], Edit]] = field(
        default_factory=dict[Path, dict[tuple[int, int], Edit]]
    )
    moves: dict[Path, Path] = field(default_factory=dict[Path, Path])
    breaking: list[Diagnostic] = field(default_factory=list[Diagnostic])
    python: list[Span] = field(default_factory=list[Span])

    def replace(self, span: Span, text: str) -> None:
        """Replace the text at a place."""
        of_file = self.edits.setdefault(span.source.path.absolute(), {})
        of_file[span.start, span.end] = Edit(span.start, span.end, text)


def can_rename(workspace: Workspace, symbol: Symbol) -> bool:
    """Whether the workspace has the file that defines a symbol."""
    interface = interface_of(workspace, symbol.type_name)
    return interface is not None and interface.package in {each.name for each in workspace.packages()}


def renaming_of(workspace: Workspace, symbol: Symbol, name: str) -> Renaming:
    """The changes that give a symbol a new name; InputError if it cannot have that."""
    _check(workspace, symbol, name)
    renaming = Renaming()
    package, _, short = symbol.type_name.split("/")
    if symbol.kind == "package":
        _rename_package(workspace, package, name, renaming)
        renaming.breaking = [_moved(package)]
        renaming.python = list(_in_python(workspace, package, re.compile(rf"\b{package}\b")))
        return renaming
    if symbol.kind == "type":
        _rename_type(workspace, symbol.type_name, name, renaming)
    else:
        span = member_span(workspace, symbol)
        assert span is not None
        renaming.replace(span, name)
    renaming.breaking = _breaking(workspace, renaming)
    old = short if symbol.kind == "type" else symbol.member
    pattern = rf"\b{old}\b" if symbol.kind == "type" else rf"\.{old}\b|\b{old}\s*=(?!=)"
    renaming.python = list(_in_python(workspace, package, re.compile(pattern)))
    return renaming


def _check(workspace: Workspace, symbol: Symbol, name: str) -> None:
    """Raise InputError if ROS does not allow a name here, or something has it."""
    interface = interface_of(workspace, symbol.type_name)
    assert interface is not None
    match symbol.kind:
        case "type":
            is_right = names.is_interface_name(name, interface.folder)
        case "field" | "package":
            is_right = names.is_package_name(name)  # the same rule
        case _:
            is_right = names.is_constant_name(name)
    if not is_right:
        raise InputError(
            [Diagnostic("invalid-name", f"ROS does not allow '{name}' as the name of a {symbol.kind}")]
        )
    if symbol.kind == "package":
        taken = {each.name for each in workspace.packages()}
    elif symbol.kind == "type":
        package = next(each for each in workspace.packages() if each.name == interface.package)
        taken = set(package.names(interface.folder))
    else:
        part = next(each for each in parts_of(interface) if each.type_name == symbol.type_name)
        taken = {each.name for each in members_of(part)}
    if name in taken:
        raise InputError([Diagnostic("duplicate-name", f"{symbol.type_name} has a '{name}' already")])


def _rename_type(workspace: Workspace, type_name: str, name: str, renaming: Renaming) -> None:
    """Move the file of a type, and change every place that names it."""
    interface = interface_of(workspace, type_name)
    assert interface is not None and interface.source is not None
    package, folder, old = type_name.split("/")
    path = interface.source.path.absolute()
    renaming.moves[path] = path.with_name(name + path.suffix)
    if path.suffix == IDL:
        for part in parts_of(interface):
            if part.span is not None:
                renaming.replace(part.span, part.name.replace(old, name, 1))
    for use in workspace.uses(type_name):
        word = use.span.source.text[use.span.start : use.span.end]
        renaming.replace(use.span, f"{word[: len(word) - len(old)]}{name}")
    own = next(each for each in workspace.packages() if each.name == package)
    listed = re.compile(rf"(?<=\b{folder}/){old}(?=\.(?:msg|srv|action|idl)\b)")
    _replace_all(workspace, own.root.absolute() / "CMakeLists.txt", listed, name, renaming)
    written = re.compile(rf"(?<=\b{package}/{folder}/){old}\b|(?<=\b{package}/){old}\b")
    for file in _texts(workspace):
        _replace_all(workspace, file, written, name, renaming)


def _rename_package(workspace: Workspace, old: str, name: str, renaming: Renaming) -> None:
    """Move the folder of a package, and change every place that names it."""
    for use in workspace.all_uses():
        word = use.span.source.text[use.span.start : use.span.end]
        if word.startswith((f"{old}/", f"{old}::")):
            renaming.replace(Span(use.span.source, use.span.start, use.span.start + len(old)), name)
    written = re.compile(rf"\b{old}(?=/(?:msg|srv|action)/|/[A-Z])")
    for file in _texts(workspace):
        _replace_all(workspace, file, written, name, renaming)
    in_idl = re.compile(rf"\b{old}(?=::|/)|(?<=\bmodule ){old}\b")
    for package in workspace.packages():
        root = package.root.absolute()
        _replace_all(workspace, root / "package.xml", re.compile(rf"(?<=>){old}(?=</)"), name, renaming)
        _replace_all(workspace, root / "CMakeLists.txt", re.compile(rf"\b{old}\b"), name, renaming)
        for interface in package.files:
            if interface.is_idl:
                _replace_all(workspace, interface.path.absolute(), in_idl, name, renaming)
        if package.name == old and root.name == old:
            renaming.moves[root] = root.with_name(name)


def _moved(package: str) -> Diagnostic:
    """The verdict on a package with another name."""
    message = f"every type of {package} has another name then, and another hash"
    return Diagnostic("package-removed", message, severity="warning", breaks=("hash", "source", "wire"))


def _replace_all(
    workspace: Workspace, path: Path, pattern: re.Pattern[str], text: str, renaming: Renaming
) -> None:
    source = workspace.source(path) if path.is_file() else None
    if source is not None:
        for match in pattern.finditer(source.text):
            renaming.replace(Span(source, *match.span()), text)


def _texts(workspace: Workspace) -> Iterator[Path]:
    """Files of the workspace that may name types: templates, configuration, descriptions, .idl files."""
    for path in _files(workspace):
        if path.suffix in _TEXT_FILES or path.suffix == IDL:
            yield path


def _files(workspace: Workspace) -> Iterator[Path]:
    """The files that people write, in the workspace."""
    output = workspace.settings().output.absolute()
    pending = [workspace.root]
    while pending:
        folder = pending.pop()
        for path in sorted(folder.iterdir()):
            if path.name.startswith(".") or path.is_symlink():
                continue
            if path.is_file():
                yield path
            elif path != output and path.name not in _SKIPPED and not is_generated(path):
                pending.append(path)


def _in_python(workspace: Workspace, package: str, pattern: re.Pattern[str]) -> Iterator[Span]:
    """The places in Python modules that name a package of messages, and what changes."""
    found = 0
    for path in _files(workspace):
        if path.suffix != ".py":
            continue
        source = workspace.source(path)
        if source is None or package not in source.text:
            continue
        for match in pattern.finditer(source.text):
            yield Span(source, *match.span())
            found += 1
            if found == _MAX_PLACES:
                return


def _breaking(workspace: Workspace, renaming: Renaming) -> list[Diagnostic]:
    """The findings of `ifgen breaking` about the change, in the packages that it changes."""
    buffers = Buffers(dict(workspace.buffers.texts), frozenset(renaming.moves))
    paths = {*renaming.edits, *renaming.moves}
    for path in paths:
        source = workspace.source(path)
        if source is not None:
            buffers.texts.pop(path, None)
            text = edited(source, renaming.edits.get(path, {}).values())
            buffers.texts[renaming.moves.get(path, path)] = text
    packages = [
        each for each in workspace.packages() if any(each.root.absolute() in path.parents for path in paths)
    ]
    with workspace.buffers.read_first(workspace.root):
        old = _version(packages, workspace.search(), workspace.understood())
    with buffers.read_first(workspace.root):
        changed, _ = find_what_can_be(each.root for each in packages)
        new = _version(changed, workspace.search().knowing(changed), workspace.understood())
    return [each for difference in compare(old, new) if (each := diagnostic(difference)) is not None]


def _version(packages: Sequence[PackageFiles], search: SearchPath, understood: Understood) -> Version:
    """A version of packages, without nodes: their descriptions change along."""
    return version.load([replace(each, nodes=()) for each in packages], search, understood)


def edited(source: Source, edits: Iterable[Edit]) -> str:
    """The text of a file with edits."""
    text = source.text
    for edit in sorted(edits, key=lambda each: -each.start):
        text = f"{text[: edit.start]}{edit.text}{text[edit.end :]}"
    return text


def summary(renaming: Renaming) -> str:
    """The effect of the change on others, in a few words for a question."""
    files = len({*renaming.edits, *renaming.moves})
    changed = f"changes {files} {'file' if files == 1 else 'files'}"
    kinds = sorted({kind for each in renaming.breaking for kind in each.breaks})
    verdict = f"breaks {', '.join(kinds)}" if kinds else "breaks nothing"
    places = f"; {len(renaming.python)} places in Python to change by hand" if renaming.python else ""
    return f"{changed}, {verdict}{places}"


def python_places(renaming: Renaming) -> str:
    """The places in Python, one a line."""
    return "\n".join(f"{shown_path(span.source.path)}:{span.line}" for span in renaming.python)
