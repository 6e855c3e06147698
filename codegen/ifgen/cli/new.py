"""`ifgen new`: the first file of a package, an interface or a node."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path

import click

from ifgen import resources
from ifgen.command_kit.options import OUTPUT_FOLDER
from ifgen.config.settings import configured_paths
from ifgen.definition import file_names, names
from ifgen.diagnostics import Diagnostic, InputError, UsageError, shown_path
from ifgen.nodl.names import node_name_problem
from ifgen.reading.packages import FOLDERS, NODE_EXTENSIONS, NODE_FOLDER, find_packages

_in = click.option(
    "--in",
    "folder",
    metavar="DIR",
    type=OUTPUT_FOLDER,
    help="The folder of the packages (default: interfaces).",
)


@click.group()
def new() -> None:
    """Start a new package, interface or node.

    Writes to the first of the paths in [tool.ifgen], or to interfaces/, and overwrites nothing.
    """


@new.command(epilog="Example: ifgen new package lab_msgs")
@click.argument("name")
@_in
def package(name: str, folder: Path | None) -> int:
    """Write package.xml and CMakeLists.txt of an interface package.

    NAME is lower case, such as demo_msgs. For a package of nodes use `ifgen new node`.
    """
    _check_package(name)
    root = _root(name, folder)
    _write(_interface_package(root, name))
    _print_next(f"ifgen new interface {name}/msg/Name")
    return 0


@new.command(epilog="Example: ifgen new interface demo_msgs/msg/Goal")
@click.argument("name", metavar="PACKAGE/FOLDER/NAME")
@_in
@click.option("--colcon", is_flag=True, help="With package.xml and CMakeLists.txt, as in a colcon workspace.")
def interface(name: str, folder: Path | None, colcon: bool) -> int:
    """Write a first message, service or action.

    FOLDER is msg, srv or action: demo_msgs/msg/Pose. Makes the package if it does not exist.
    """
    parts = name.split("/")
    if len(parts) != 3 or parts[1] not in FOLDERS:
        help = "write it with its package and its folder, such as demo_msgs/msg/Pose"
        raise _invalid(f"`{name}` does not say which interface to make", help)
    package_name, kind, own = parts[0], parts[1], parts[2]
    _check_package(package_name)
    if not names.is_interface_name(own, kind):
        camel = "".join(word[:1].upper() + word[1:] for word in re.split(r"[^A-Za-z0-9]+", own))
        hint = f"did you mean {package_name}/{kind}/{camel}? " if names.is_interface_name(camel, kind) else ""
        raise _invalid(f"`{own}` is not a valid name", f"{hint}A capital letter, then letters and digits")
    root = _root(package_name, folder)
    path = root / kind / f"{own}.{kind}"
    is_wanted = not (root / "package.xml").exists() and (colcon or _is_in_workspace(root))
    package = _interface_package(root, package_name) if is_wanted else {}
    _write({**package, path: resources.skeleton(f"interface.{kind}")})
    if _is_left_out(path):
        click.echo(
            f"add {kind}/{path.name} to the list in {shown_path(root / 'CMakeLists.txt')}, or it is left out"
        )
    _print_next(f"ifgen generate {shown_path(root)}")
    return 0


@new.command(epilog="Example: ifgen new node gait_planner")
@click.argument("name", metavar="[PACKAGE/]NAME")
@_in
def node(name: str, folder: Path | None) -> int:
    """Write a first description of a node.

    NAME is the name of the node, such as gait_planner. PACKAGE has the same name by default, and is made
    if it does not exist.
    """
    package_name, slash, own = name.rpartition("/")
    if problem := node_name_problem(own):
        raise _invalid(f"`{own}` {problem.message}", problem.advice)
    _check_package(package_name if slash else own)
    root = _root(package_name or own, folder)
    path = root / NODE_FOLDER / f"{own}.nodl.yaml"
    for extension in NODE_EXTENSIONS:
        if (other := path.with_name(own + extension)) != path and other.exists():
            raise _existing([other])
    manifest = root / "package.xml"
    package = {manifest: resources.skeleton("node_package.xml", name=package_name or own)}
    _write(
        {
            **({} if manifest.exists() else package),
            path: resources.skeleton("node.nodl.yaml", name=own, schema=resources.NODL_SCHEMA),
        }
    )
    _print_next(f"ifgen check {shown_path(root)}", f"ifgen generate {shown_path(root)}")
    return 0


def _check_package(name: str) -> None:
    problem = file_names.problem(name)
    if problem is not None and problem.severity == "error":
        raise _invalid(problem.message, problem.help)


def _root(package_name: str, folder: Path | None) -> Path:
    """The folder of a package: where it is already, else a new one among the others."""
    base = folder
    if base is None:
        configured = configured_paths()
        folders = [path for path in configured if path.is_dir()]
        missing = [path for path in configured if not path.exists()]
        base = next(iter(folders or missing), Path("interfaces"))
    try:
        found = [found.root for found in find_packages([base]) if found.name == package_name]
    except InputError:  # there is none yet, or others are wrong
        found = []
    return found[0] if found else base / package_name


def _is_in_workspace(root: Path) -> bool:
    """Whether ROS 2 is sourced, colcon has built in a folder above, or a package beside has CMake."""
    built = (parent / "install" / ".colcon_install_layout" for parent in root.absolute().parents)
    return (
        bool(os.environ.get("AMENT_PREFIX_PATH"))
        or any(path.exists() for path in built)
        or any(root.absolute().parent.glob("*/CMakeLists.txt"))
    )


def _is_left_out(path: Path) -> bool:
    """Whether a new file is not in the list of its package."""
    with suppress(InputError):
        found = (d for package in find_packages([path]) if package.listed for d in package.listed.diagnostics)
        return any(diagnostic.rule == "unlisted-interface" for diagnostic in found)
    return False


def _interface_package(root: Path, name: str) -> dict[Path, str]:
    """The files that colcon needs to build an interface package."""
    return {
        root / "package.xml": resources.skeleton("interface_package.xml", name=name),
        root / "CMakeLists.txt": resources.skeleton("CMakeLists.txt", name=name),
    }


def _write(files: dict[Path, str]) -> None:
    if existing := [path for path in files if path.exists()]:
        raise _existing(existing)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
        click.echo(f"wrote {shown_path(path)}")


def _print_next(*commands: str) -> None:
    click.echo(f"next: {', or '.join(f'`{command}`' for command in commands)}")


def _existing(paths: list[Path]) -> UsageError:
    message = f"{shown_path(paths[0])} exists"
    return UsageError([Diagnostic("existing-file", message, help="choose another name, or change that file")])


def _invalid(message: str, help: str | None) -> UsageError:
    return UsageError([Diagnostic("invalid-name", message, help=help)])
