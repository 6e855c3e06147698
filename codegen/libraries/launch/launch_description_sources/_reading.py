"""Launch files of each kind, read to one model; those in Python by `generate_launch_description`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from launch._errors import LaunchError, explained
from launch.launch_description import LaunchDescription

SUFFIXES = (".py", ".xml", ".launch", ".yaml", ".yml")


def read(path: str) -> LaunchDescription:
    """Return the description in a file. Raises LaunchError."""
    file = Path(path)
    if not file.is_file():
        what = "it is a folder" if file.is_dir() else "there is no such file"
        raise LaunchError(f"cannot read the launch file '{path}': {what}")
    if file.suffix == ".py":
        return read_python(file)
    if file.suffix not in SUFFIXES:
        raise LaunchError(f"'{path}' is no launch file", help="its name ends in .py, .xml or .yaml")
    from launch.frontend.parser import Parser  # it imports all actions, which import this

    root, parser = Parser.load(file)
    return parser.parse_description(root)


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Run a launch file in Python, and return it as a module; raises what it raises."""
    file = Path(python_launch_file_path)
    name = "ifgen_launch_file_" + "".join(c if c.isalnum() else "_" for c in file.stem)
    specification = importlib.util.spec_from_file_location(name, file)
    if specification is None or specification.loader is None:
        raise LaunchError("this is no Python file", (str(file), 1))
    module = importlib.util.module_from_spec(specification)
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # nobody wants a folder of them beside their launch files
    try:
        specification.loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = before
    return module


def read_python(file: Path) -> LaunchDescription:
    """Run a file, and return its description. Raises LaunchError for whatever it raises."""
    place = (str(file), 1)
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # also of the modules that it imports when it is asked
    try:
        module = load_python_launch_file_as_module(str(file))
        generate = getattr(module, "generate_launch_description", None)
        if generate is None:
            raise LaunchError("there is no function generate_launch_description() in this file", place)
        description = generate()
    except Exception as error:
        raise explained(error, place) from error
    finally:
        sys.dont_write_bytecode = before
    if not isinstance(description, LaunchDescription):
        kind = type(description).__name__
        raise LaunchError(f"generate_launch_description() must return a LaunchDescription, got {kind}", place)
    return description
