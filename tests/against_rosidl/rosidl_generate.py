"""Generate Python classes with rosidl itself, without a compiler: `rosidl_generate.py PACKAGE_FOLDER OUTPUT`."""

from __future__ import annotations

import contextlib
import io
import json
import pathlib
import sys

from rosidl_adapter import convert_to_idl
from rosidl_generator_py import generate_py


def main() -> None:
    """Write OUTPUT/<package>."""
    source, output = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    share = pathlib.Path(sys.prefix) / "share"
    idl = output / "idl"
    tuples = []
    with contextlib.redirect_stdout(io.StringIO()):
        for file in sorted(source.glob("*/*")):
            relative = file.relative_to(source)
            if file.suffix == ".idl":
                tuples.append(f"{source}:{relative}")
                continue
            convert_to_idl(source, source.name, relative, idl)
            tuples.append(f"{idl}:{relative.with_suffix('.idl')}")
    arguments = output / "arguments.json"
    values = {
        "package_name": source.name,
        "output_dir": str(output / source.name),
        "idl_tuples": tuples,
        "include_paths": [f"{folder.name}:{folder}" for folder in share.iterdir() if folder.is_dir()],
        "template_dir": str(share / "rosidl_generator_py" / "resource"),
        "target_dependencies": [],
        "ros_interface_dependencies": [],
    }
    arguments.write_text(json.dumps(values))
    generate_py(str(arguments), [])
    (output / source.name / "__init__.py").touch()


if __name__ == "__main__":
    main()
