"""Packages by name, and their executables: generated, as sources, installed by pip, or in a ROS."""

from __future__ import annotations

import ast
import configparser
import os
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Final

from ifgen import resources
from ifgen.activation import is_node_package
from ifgen.command_kit.tool import did_you_mean
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.reading import package_xml

_INDEX: Final = "share/ament_index/resource_index/packages"
_ENTRY_POINT: Final = "ifgen_tools.running.entry_point"

_LIBRARIES: Final = {
    "joint_state_publisher": ("robot_state_publisher", ["robot_state_publisher.joint_state_publisher"]),
    "robot_state_publisher": ("robot_state_publisher", ["robot_state_publisher.robot_state_publisher"]),
    "tf2_ros": ("tf2_ros", ["tf2_ros.static_transform_publisher"]),
}
"""The packages of programs among ifgen's libraries: the folder of each, and the modules of its programs."""


@dataclass(frozen=True, slots=True)
class Executable:
    """A program of a package: the words for `ifgen run` if it is Python, else those that start it."""

    name: str
    words: tuple[str, ...]
    is_python: bool = True


@dataclass(frozen=True)
class Package:
    """A package, the folder of its shared files, and the folder that it is installed in, if it is."""

    name: str
    share: Path
    executables: Mapping[str, Executable] = field(repr=False)
    prefix: Path | None = None


def find(name: str, output: Path, near: Iterable[Path] = ()) -> Package | None:
    """Return a package: the generated one in `output`, sources here or `near`, or what is installed.

    At last, one of ifgen's libraries, or of its own humanoid. None if there is none.
    """
    places = list(near)
    for look in (_generated(output / name), *_sources(name, places), _distributed(name), *_indexed(name)):
        if look is not None:
            return look
    is_humanoid = any(resources.humanoid() in place.parents for place in places)
    if name in _LIBRARIES and not is_humanoid:  # whose joint_state_publisher is another one
        share, modules = _LIBRARIES[name]
        found = {each.rpartition(".")[2]: each for each in modules}
        programs = {short: Executable(short, ("-m", module)) for short, module in found.items()}
        return Package(name, resources.libraries() / share, programs)
    return _generated(resources.bundled_nodes() / name) or _source(name, resources.humanoid())


def executable(package_name: str, name: str, output: Path, near: Iterable[Path] = ()) -> Executable:
    """Return an executable of a package. Raises UsageError, which names those that are there."""
    package = find(package_name, output, near)
    if package is None:
        raise UsageError([missing(package_name, output)])
    return executable_of(package, name)


def executable_of(package: Package, name: str) -> Executable:
    """Return an executable of a package. Raises UsageError, which names those that are there."""
    if name not in package.executables:
        names = sorted(package.executables)
        meant = did_you_mean(name, names, limit=1, cutoff=0.6)
        help = f"{meant} it has {', '.join(names) or 'none'}".lstrip()
        message = f"the package '{package.name}' in {package.share} has no executable '{name}'"
        raise UsageError([Diagnostic("no-program", message, help=help)])
    return package.executables[name]


def missing(package_name: str, output: Path) -> Diagnostic:
    """Say that there is no such package, and where ifgen looked."""
    meant = did_you_mean(package_name, names(output), limit=1, cutoff=0.6)
    looked = f"ifgen looked in {output}, for sources in {Path.cwd()}, and among the installed packages"
    return Diagnostic(
        "no-package", f"there is no package '{package_name}'", help=f"{meant} {looked}".lstrip()
    )


def names(output: Path) -> list[str]:
    """Return the names of packages: generated, sources here, and installed."""
    folders = (output, resources.bundled_nodes())
    generated = {
        e.name for folder in folders if folder.is_dir() for e in folder.iterdir() if is_node_package(e)
    }
    indexed = {
        entry.name
        for prefix in _prefixes()
        if (prefix / _INDEX).is_dir()
        for entry in (prefix / _INDEX).iterdir()
        if not entry.name.startswith(".")
    }
    sources = {name for folder in source_folders() if (name := _name_in(folder))}
    return sorted(generated | indexed | sources)


def source_folders(near: Iterable[Path] = ()) -> list[Path]:
    """Return the folders of packages whose sources `find` would take: here, in `src`, and around `near`."""
    found = (folder for root in _roots(near) for folder in (root, *_inside(root)))
    return [folder for folder in dict.fromkeys(found) if _name_in(folder)]


def _inside(folder: Path) -> list[Path]:
    with suppress(OSError):
        return sorted(entry for entry in folder.iterdir() if (entry / package_xml.NAME).is_file())
    return []


def _generated(folder: Path) -> Package | None:
    if not is_node_package(folder):
        return None
    files = (f for f in (folder / folder.name).glob("[!_]*.py"))
    scripts = _scripts_in_setup_py(folder / "setup.py")
    found = {f.stem: Executable(f.stem, (str(f),)) for f in files if f.stem in scripts}
    return Package(folder.name, folder.resolve(), found)


def _sources(name: str, near: Iterable[Path]) -> Iterator[Package | None]:
    for root in _roots(near):
        yield from (_source(name, folder) for folder in (root, root / name))


def _roots(near: Iterable[Path]) -> list[Path]:
    """The folders that are packages or contain some."""
    here = Path.cwd()
    return list(dict.fromkeys((here, here / "src", *(p for place in near for p in list(place.parents)[:3]))))


def _source(name: str, folder: Path) -> Package | None:
    if _name_in(folder) != name or is_node_package(folder):
        return None
    # The shared files of an installation: its executables are elsewhere.
    installed = _installed(name, folder.parent.parent) if folder.parent.name == "share" else None
    if installed is not None:
        return installed
    scripts = _scripts_in_setup_py(folder / "setup.py") | _scripts_in_tables(folder)
    found = {script: _entry(script, target, folder) for script, target in scripts.items()}
    return Package(name, folder.resolve(), found)


def _name_in(folder: Path) -> str | None:
    read = package_xml.read(folder, []) if (folder / package_xml.NAME).is_file() else None
    return None if read is None else read.name


def _distributed(name: str) -> Package | None:
    try:
        distribution = metadata.distribution(name)
    except (metadata.PackageNotFoundError, ValueError):
        return None
    scripts = distribution.entry_points.select(group="console_scripts")
    if not scripts and not (Path(sys.prefix) / _INDEX / name).is_file():
        return None  # a library that happens to have the name
    share = Path(sys.prefix, "share", name)
    place = share if share.is_dir() else Path(str(distribution.locate_file("")))
    found = {script.name: _entry(script.name, script.value, None) for script in scripts}
    return Package(name, place, found, Path(sys.prefix))


def _entry(script: str, target: str, folder: Path | None) -> Executable:
    place = "" if folder is None else str(folder.resolve())
    return Executable(script, ("-m", _ENTRY_POINT, script, place, target.partition("[")[0].strip()))


def _indexed(name: str) -> Iterator[Package | None]:
    for prefix in _prefixes():
        yield _installed(name, prefix)


def _installed(name: str, prefix: Path) -> Package | None:
    if not (prefix / _INDEX / name).is_file():
        return None
    folder = prefix / "lib" / name
    files = sorted(folder.iterdir()) if folder.is_dir() else []
    found = {f.name: _program(f) for f in files if f.is_file() and os.access(f, os.X_OK)}
    return Package(name, prefix / "share" / name, found, prefix)


def _program(file: Path) -> Executable:
    return Executable(file.name, (str(file),), is_python=is_python(file))


def is_python(file: Path) -> bool:
    """Whether a file is a program in Python, by its suffix or by its first line."""
    if file.suffix == ".py":
        return True
    with suppress(OSError), file.open("rb") as opened:
        first = opened.readline(256)
        return first.startswith(b"#!") and b"python" in first
    return False


def _prefixes() -> list[Path]:
    listed = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(prefix) for prefix in dict.fromkeys((*listed, sys.prefix)) if prefix]


@cache
def _scripts_in_setup_py(file: Path) -> dict[str, str]:
    """The console scripts that a setup.py spells out; it is never run."""
    try:
        tree = ast.parse(file.read_bytes())
    except (OSError, ValueError, SyntaxError, RecursionError):
        return {}
    lines: list[str] = []
    for table in (node for node in ast.walk(tree) if isinstance(node, ast.Dict)):
        for key, value in zip(table.keys, table.values, strict=True):
            if isinstance(key, ast.Constant) and key.value == "console_scripts":
                words = (each.value for each in ast.walk(value) if isinstance(each, ast.Constant))
                lines += [word for word in words if isinstance(word, str)]
    return _pairs("\n".join(lines))


def _scripts_in_tables(folder: Path) -> dict[str, str]:
    found: dict[str, str] = {}
    with suppress(OSError, UnicodeDecodeError, configparser.Error):
        parser = configparser.ConfigParser(interpolation=None)
        parser.read_string((folder / "setup.cfg").read_text(encoding="utf-8"))
        found |= _pairs(parser.get("options.entry_points", "console_scripts", fallback=""))
    with suppress(OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        table = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
        scripts = table.get("project", {}).get("scripts", {})
        found |= {str(name): str(target) for name, target in scripts.items()}
    return found


def _pairs(text: str) -> dict[str, str]:
    pairs = (line.partition("=") for line in text.splitlines() if ":" in line)
    return {name.strip(): target.strip() for name, equals, target in pairs if equals}
