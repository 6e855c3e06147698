"""Launch files in Python: their function `generate_launch_description`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from launch import LaunchDescription

from ifgen_tools.launching.errors import LaunchError, explained


def read_python(file: Path) -> LaunchDescription:
    """Run a file, and return its description. Raises LaunchError for whatever it raises."""
    place = (str(file), 1)
    name = "ifgen_launch_file_" + "".join(c if c.isalnum() else "_" for c in file.stem)
    specification = importlib.util.spec_from_file_location(name, file)
    if specification is None or specification.loader is None:
        raise LaunchError("this is no Python file", place)
    module = importlib.util.module_from_spec(specification)
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # nobody wants a folder of them beside their launch files
    try:
        specification.loader.exec_module(module)
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
