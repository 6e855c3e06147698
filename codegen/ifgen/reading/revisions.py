"""The files of a git revision, read from the repository into memory. Nothing is checked out."""

from __future__ import annotations

import os
import posixpath
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

from ifgen.diagnostics import Diagnostic, UsageError, shorten, shown_path
from ifgen.reading.listed_file import EXTENSIONS
from ifgen.reading.storage import Entry

_READ_AT_ONCE: Final = (*EXTENSIONS, ".cmake", ".yaml", ".yml", ".json", "CMakeLists.txt", "package.xml")
"""The ends of the names of files that may be about interfaces or nodes; others are read when asked for."""

_LINK: Final = "120000"
_SUBMODULE: Final = "160000"
_OF_A_HOOK: Final = ("GIT_DIR", "GIT_INDEX_FILE", "GIT_PREFIX", "GIT_WORK_TREE", "GIT_OBJECT_DIRECTORY")
_TIMEOUT: Final = 120  # seconds; a repository on a network that is gone keeps git waiting


class _Object(NamedTuple):
    """A file of a revision: its mode, the name of its contents, and the repository that has these."""

    mode: str
    name: str
    repository: str


@dataclass
class Revision:
    """The files of a repository as of a revision, as a `storage.Snapshot`.

    `submodules` are the folders of submodules that lack the commit of this revision.
    """

    name: str
    roots: tuple[str, ...]
    submodules: tuple[str, ...]
    _objects: Mapping[str, _Object] = field(repr=False)
    _contents: dict[str, bytes] = field(default_factory=dict[str, bytes], repr=False)
    _folders: dict[str, dict[str, Entry]] = field(default_factory=dict[str, dict[str, Entry]], repr=False)

    def __post_init__(self) -> None:
        self._folders[""] = {}
        for path in self._objects:
            self._note(path)

    def entries(self, path: str) -> list[Entry] | None:
        """The contents of a folder; None if there is no such folder."""
        found = self._folders.get(path)
        return None if found is None else list(found.values())

    def has_file(self, path: str) -> bool:
        """Whether there is such a file."""
        return path in self._objects

    def read(self, path: str) -> bytes | None:
        """The contents of a file; None if there is no such file."""
        found = self._objects.get(path)
        if found is None:
            return None
        if found.name not in self._contents:
            self._contents.update(_contents([found]))
        return self._contents[found.name]

    def fetch(self) -> None:
        """Read all files that may be about interfaces or nodes, in one go."""
        wanted = {o.name: o for path, o in self._objects.items() if path.endswith(_READ_AT_ONCE)}
        self._contents.update(_contents(list(wanted.values())))

    def _note(self, path: str) -> None:
        """Enter a file into its folder, and that into the folders above."""
        entry = Entry(posixpath.basename(path), False)
        while True:
            path = posixpath.dirname(path)
            is_known = path in self._folders
            self._folders.setdefault(path, {})[entry.name] = entry
            if is_known:
                return
            entry = Entry(posixpath.basename(path), True)


def revision_of(place: Path, name: str) -> Revision:
    """The revision `name` of the repository that contains a place.

    Raises UsageError if there is no git, no repository or no such revision.
    """
    folder = _existing(place)
    top = _git(folder, "rev-parse", "--show-toplevel", "--show-cdup")
    if top.returncode:
        raise UsageError([_no_repository(folder, name, top.stderr)])
    lines = top.stdout.decode(errors="surrogateescape").split("\n")
    root, as_given = lines[0], os.path.normpath(Path(folder, lines[1]).absolute())
    commit = _commit(root, name)
    objects, missing = _objects_of(root, commit)
    found = Revision(name, tuple(dict.fromkeys((as_given, os.path.normpath(root)))), missing, objects)
    found.fetch()
    return found


def is_revision(place: Path, name: str) -> bool:
    """Whether the repository that contains a place, if any, has this revision."""
    try:
        found = _git(_existing(place), *_verify(name))
    except UsageError:
        return False
    return found.returncode == 0 and not name.startswith("-")


def names(place: Path) -> list[str]:
    """The names of branches and tags of the repository that contains a place; none if there is none."""
    try:
        listed = _git(_existing(place), "for-each-ref", "--format=%(refname:short)")
    except UsageError:
        return []
    return ["HEAD", *listed.stdout.decode(errors="replace").splitlines()] if listed.returncode == 0 else []


def history(path: Path, most: int) -> list[tuple[str, str]]:
    """The commits that changed a file, with its text in each, the latest first; none without a repository."""
    place = _existing(path.parent)
    try:
        listed = _git(place, "log", f"-{most}", "--format=%h", "--", str(path.absolute()))
        commits = listed.stdout.decode().split() if listed.returncode == 0 else []
        shown = [(c, _git(place, "show", f"{c}:./{path.name}")) for c in commits]
    except UsageError:
        return []
    return [(c, s.stdout.decode(errors="replace")) for c, s in shown if s.returncode == 0]


def _verify(name: str) -> Sequence[str]:
    return "rev-parse", "--verify", "--quiet", f"{name}^{{commit}}"


def _existing(place: Path) -> Path:
    """The nearest folder upwards that exists: a place may be gone since, or not have been there yet."""
    absolute = place.absolute()
    return next(folder for folder in (absolute, *absolute.parents) if folder.is_dir())


def _commit(root: str, name: str) -> str:
    """The commit of this name. Raises UsageError if there is none."""
    if name and not name.startswith("-") and "\0" not in name:
        found = _git(root, *_verify(name))
        if found.returncode == 0:
            return found.stdout.decode().strip()
    raise UsageError([_no_revision(root, name)])


def has_no_commit(root: Path | str) -> bool:
    """Whether nothing was ever committed in the repository around a folder, or there is none."""
    return _git(root, *_verify("HEAD")).returncode != 0


def _objects_of(root: str, commit: str, within: str = "") -> tuple[dict[str, _Object], tuple[str, ...]]:
    """The files of a commit by path, those of its submodules too, and the submodules that cannot be read."""
    listed = _git(root, "ls-tree", "-r", "-z", "--full-tree", commit)
    if listed.returncode:
        raise UsageError([_failed(root, listed.stderr)])
    objects: dict[str, _Object] = {}
    missing: list[str] = []
    for line in listed.stdout.split(b"\0")[:-1]:
        facts, _, path = line.partition(b"\t")
        mode, _, name = facts.decode().split(" ")
        where = within + path.decode(errors="surrogateescape")
        if mode != _SUBMODULE:
            objects[where] = _Object(mode, name, root)
            continue
        place = os.path.join(root, path.decode(errors="surrogateescape"))  # noqa: PTH118 - bytes of any kind
        if not os.path.lexists(os.path.join(place, ".git")):  # noqa: PTH118 - nor can its files be read today
            continue
        if _git(place, "cat-file", "-e", f"{name}^{{commit}}").returncode:
            missing.append(where)
            continue
        inside, gone = _objects_of(place, name, f"{where}/")
        objects |= inside
        missing += gone
    _follow_links(objects)
    return objects, tuple(missing)


def _follow_links(objects: dict[str, _Object]) -> None:
    """Put the file or the files that a symbolic link leads to in its place; a link out of the tree goes."""
    links = {path: found for path, found in objects.items() if found.mode == _LINK}
    if not links:
        return
    targets = _contents(list(links.values()))
    for path in links:
        del objects[path]
    known = dict(objects)
    for path, found in links.items():
        text = targets[found.name].decode(errors="surrogateescape")
        target = posixpath.normpath(posixpath.join(posixpath.dirname(path), text))
        if target in known:
            objects[path] = known[target]
            continue
        inside = ((p, o) for p, o in known.items() if p.startswith(f"{target}/"))
        objects.update((path + p[len(target) :], o) for p, o in inside)


def _contents(objects: Sequence[_Object]) -> dict[str, bytes]:
    """The contents of files by their names, with one git for each repository."""
    found: dict[str, bytes] = {}
    for root in dict.fromkeys(o.repository for o in objects):
        names = dict.fromkeys(o.name for o in objects if o.repository == root)
        done = _git(root, "cat-file", "--batch", input="".join(f"{name}\n" for name in names).encode())
        if done.returncode:
            raise UsageError([_failed(root, done.stderr)])
        found.update(_batch(done.stdout, root))
    return found


def _batch(output: bytes, root: str) -> Iterator[tuple[str, bytes]]:
    """Each name with its contents, of what `git cat-file --batch` prints."""
    at = 0
    while at < len(output):
        end = output.index(b"\n", at)
        name, *facts = output[at:end].decode().split(" ")
        if len(facts) != 2:  # `missing`: a clone without the contents of all files
            raise UsageError([_failed(root, f"object {name} is missing".encode())])
        size = int(facts[1])
        yield name, output[end + 1 : end + 1 + size]
        at = end + size + 2


def _git(
    folder: Path | str, *arguments: str, input: bytes | None = None
) -> subprocess.CompletedProcess[bytes]:
    environment = {name: value for name, value in os.environ.items() if name not in _OF_A_HOOK}
    environment |= {"LC_ALL": "C", "GIT_OPTIONAL_LOCKS": "0", "GIT_TERMINAL_PROMPT": "0"}
    try:
        return subprocess.run(
            ["git", "-C", str(folder), *arguments],
            input=input,
            stdin=subprocess.DEVNULL if input is None else None,
            capture_output=True,
            env=environment,
            timeout=_TIMEOUT,
            check=False,
        )
    except FileNotFoundError:
        advice = "install git, or name a folder with the earlier files"
        raise UsageError([Diagnostic("no-git", "git is not installed", help=advice)]) from None
    except subprocess.TimeoutExpired:
        message = f"git has not answered for {_TIMEOUT} s in {shown_path(Path(folder))}"
        raise UsageError([Diagnostic("no-git", message)]) from None


def _no_repository(folder: Path, name: str, said: bytes) -> Diagnostic:
    reason = said.decode(errors="replace").strip()
    if "not a git repository" in reason:
        message = f"{folder} is not in a git repository, and there is no folder '{shorten(name)}'"
        return Diagnostic("unknown-revision", message, help="name a folder with the earlier files")
    return _failed(folder, said)


def _no_revision(root: str, name: str) -> Diagnostic:
    message = f"'{shorten(name)}' is neither a revision of {root} nor a folder"
    shallow = _git(root, "rev-parse", "--is-shallow-repository")
    if shallow.stdout.strip() == b"true":
        advice = "this clone is shallow: `git fetch --unshallow`, or `fetch-depth: 0` of actions/checkout"
    elif has_no_commit(root):
        advice = "the repository has no commit yet"
    else:
        advice = "`git log --oneline --all` lists revisions; one of a server may need `git fetch`"
    return Diagnostic("unknown-revision", message, help=advice)


def _failed(root: Path | str, said: bytes) -> Diagnostic:
    first, _, rest = said.decode(errors="replace").strip().partition("\n")
    message = f"git cannot read {shown_path(Path(root))}: {first or 'it fails without a word'}"
    return Diagnostic("no-git", message, help=rest.strip() or None)
