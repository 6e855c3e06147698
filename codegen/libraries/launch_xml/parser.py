"""Launch files in XML: each element is an entity."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

from launch import frontend
from launch._errors import LaunchError
from launch.frontend.entity import MAX_DEPTH, Entity


def read_xml(file: Path, text: str) -> Entity:
    """Return the element `launch` of a file. Raises LaunchError."""
    parser = expat.ParserCreate()
    roots: list[Entity] = []
    open_elements: list[Entity] = []

    def place() -> tuple[str, int]:
        return str(file), parser.CurrentLineNumber

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(open_elements) >= MAX_DEPTH:
            raise LaunchError(f"more than {MAX_DEPTH} elements within each other", place())
        here = place()
        element = Entity(name, here, True, {key: (value, here) for key, value in attributes.items()})
        element.around = open_elements[-1] if open_elements else None
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(name: str) -> None:
        open_elements.pop()

    def characters(data: str) -> None:
        if data.strip():
            raise LaunchError(f"unexpected text '{data.strip()[:40]}': values are attributes", place())

    def entity(*_: object) -> None:
        raise LaunchError("entities of XML cannot be declared in a launch file", place())

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = characters
    parser.EntityDeclHandler = entity
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        raise LaunchError(
            f"this is not XML: {expat.errors.messages[error.code]}", (str(file), error.lineno)
        ) from None
    if roots[0].kind != "launch":
        raise roots[0].error(f"the outermost element must be 'launch', got '{roots[0].kind}'")
    return roots[0]


class Parser(frontend.Parser):
    """Builds actions from launch files in XML."""

    @classmethod
    def get_available_extensions(cls) -> list[str]:
        """Return the ends of the names of files that it reads."""
        return ["xml"]
