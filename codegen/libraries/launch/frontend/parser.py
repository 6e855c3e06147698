# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Reads launch files in XML and YAML, and builds the actions that their elements stand for."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, ClassVar, TextIO

from launch._errors import LaunchError, explained
from launch.action import Action
from launch.conditions import IfCondition, UnlessCondition
from launch.frontend import _elements
from launch.frontend.entity import Entity
from launch.frontend.expose import exposed_actions, load_extensions
from launch.frontend.parse_substitution import parse_substitution
from launch.launch_description import LaunchDescription
from launch.substitution import Substitution

InvalidFrontendLaunchFileError = LaunchError

Reader = Callable[[Entity, "Parser"], dict[str, Any]]
"""Returns the arguments of an action, as its element has them."""


class Parser:
    """Builds actions from the elements of one file."""

    kinds: ClassVar[dict[str, type[Action]]] = {}
    """The actions by the names of their elements."""
    readers: ClassVar[dict[type[Action], Reader]] = {}
    containing: ClassVar[set[type[Action]]] = set()
    """The actions whose elements have actions inside."""

    @classmethod
    def add(
        cls,
        kinds: Mapping[str, type[Action]],
        readers: Mapping[type[Action], Reader],
        containing: set[type[Action]],
    ) -> None:
        """Add the actions of a package."""
        cls.kinds.update(kinds)
        cls.readers.update(readers)
        cls.containing.update(containing)

    @classmethod
    def get_available_extensions(cls) -> list[str]:
        """Return the ends of the names of files that can be read."""
        return ["xml", "yaml", "yml"]

    @classmethod
    def is_extension_valid(cls, extension: str) -> bool:
        """Return whether files whose names have this end can be read."""
        return extension in cls.get_available_extensions()

    @classmethod
    def load_launch_extensions(cls) -> None:
        """Import the packages that have actions and substitutions of their own."""
        load_extensions()

    @classmethod
    def load(cls, file: str | Path | TextIO) -> tuple[Entity, Parser]:
        """Return the outermost element of a file, and a parser for it. Raises LaunchError."""
        load_extensions()
        path = Path(getattr(file, "name", "<text>") if isinstance(file, io.TextIOBase) else str(file))
        text = file.read() if isinstance(file, io.TextIOBase) else _text(path)
        is_xml = path.suffix in {".xml", ".launch"} or (
            path.suffix not in {".yaml", ".yml"} and text.lstrip().startswith("<")
        )
        if is_xml:
            from launch_xml.parser import read_xml as read_tree  # each launch needs one of the two
        else:
            from launch_yaml.parser import read_yaml as read_tree  # as above
        return read_tree(path, text), cls()

    def parse_description(self, entity: Entity) -> LaunchDescription:
        """Return the description in the element `launch`. Raises LaunchError."""
        entity.raw("version")
        reason = entity.text("deprecated")
        found = LaunchDescription(
            [self.parse_action(child) for child in entity.children], deprecated_reason=reason
        )
        entity.finish(but="its children are actions")
        found.place = entity.place
        return found

    def parse_action(self, entity: Entity) -> Action:
        """Return the action that an element stands for. Raises LaunchError."""
        kind = exposed_actions.get(entity.kind) or self.kinds.get(entity.kind)
        if kind is None:
            known = sorted({*self.kinds, *exposed_actions})
            close = get_close_matches(entity.kind, known, n=1)
            help = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(known)}"
            raise entity.error(f"`ifgen launch` has no action '{entity.kind}'", help)
        try:
            build, arguments = kind.parse(entity, self)
            found = build(**arguments)
        except (TypeError, ValueError, RuntimeError, AttributeError) as error:
            raise explained(error, entity.place) from None
        entity.finish(but="actions" if self.containing.intersection(kind.__mro__) else "")
        found.place = entity.place
        return found

    def arguments(self, kind: type[Action], entity: Entity) -> dict[str, Any]:
        """Return the arguments that an action or the nearest of its bases takes. Raises LaunchError."""
        arguments: dict[str, Any] = {"condition": _condition(entity)}
        reader = next((self.readers[base] for base in kind.__mro__ if base in self.readers), None)
        return arguments if reader is None else {**arguments, **reader(entity, self)}

    def parse_substitution(self, value: str) -> list[Substitution]:
        """Return the parts of a text. Raises LaunchError."""
        return parse_substitution(value)

    def parse_if_substitutions(self, value: Any) -> Any:
        """Return a value, and the parts of each text in it that has substitutions. Raises LaunchError."""
        if isinstance(value, str):
            return parse_substitution(value) if "$(" in value else value
        return [self.parse_if_substitutions(each) for each in value] if isinstance(value, list) else value

    def escape_characters(self, value: str) -> str:
        """Return a text that stands for itself."""
        return value.replace("\\", "\\\\").replace("$(", "\\$(")


Parser.add(_elements.KINDS, _elements.READERS, _elements.CONTAINING)


def _condition(entity: Entity) -> IfCondition | UnlessCondition | None:
    positive, negative = (_predicate(entity, name) for name in ("if", "unless"))
    if positive is not None and negative is not None:
        raise entity.error(f"'{entity.kind}' has both 'if' and 'unless': one of them")
    if positive is not None:
        return IfCondition(positive)
    return None if negative is None else UnlessCondition(negative)


def _predicate(entity: Entity, name: str) -> Any:
    value = entity.raw(name)
    return str(value).lower() if isinstance(value, bool) else entity.substitutions(name)


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise LaunchError(f"cannot read the launch file '{file}': {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise LaunchError(
            "this file is not UTF-8", (str(file), error.object[: error.start].count(b"\n") + 1)
        ) from None
