"""Launch files in Python, XML and YAML, read to one model."""

from __future__ import annotations

from pathlib import Path

from launch import LaunchDescription

from ifgen_tools.launching.errors import LaunchError

# Late imports: each reader loads what it needs.

SUFFIXES = (".py", ".xml", ".launch", ".yaml", ".yml")


def read(path: str) -> LaunchDescription:
    """Return the description in a file. Raises LaunchError."""
    file = Path(path)
    if not file.is_file():
        what = "it is a folder" if file.is_dir() else "there is no such file"
        raise LaunchError(f"cannot read the launch file '{path}': {what}")
    match file.suffix:
        case ".py":
            from ifgen_tools.launching.reading.python_file import read_python

            return read_python(file)
        case ".xml" | ".launch":
            from ifgen_tools.launching.reading.xml_file import read_xml as to_tree
        case ".yaml" | ".yml":
            from ifgen_tools.launching.reading.yaml_file import read_yaml as to_tree
        case _:
            raise LaunchError(f"'{path}' is no launch file", help="its name ends in .py, .xml or .yaml")
    from ifgen_tools.launching.reading.actions import description

    return description(to_tree(file, _text(file)))


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise LaunchError(f"cannot read the launch file '{file}': {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise LaunchError(
            "this file is not UTF-8", (str(file), error.object[: error.start].count(b"\n") + 1)
        ) from None
