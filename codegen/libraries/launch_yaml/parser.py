# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Launch files in YAML: `launch:` with a list of entities, each a mapping from its kind to its attributes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from ifgen_runtime.parameters.parameter_scalars import read_scalar
from launch import frontend
from launch._errors import LaunchError, Place
from launch.frontend.entity import MAX_DEPTH, Entity

_CHILDREN = "children"
_PARAMETERS = ("param", "set_parameter")


def read_yaml(file: Path, text: str) -> Entity:
    """Return the element `launch` of a file. Raises LaunchError."""
    try:
        root = yaml.compose(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark is not None else 1
        raise LaunchError(f"this is not YAML: {error.problem or error.context}", (str(file), line)) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        message = str(error).partition("\n")[0] or "it is nested too deeply"
        raise LaunchError(f"this is not YAML: {message}", (str(file), 1)) from None
    return _File(str(file)).whole(root)


class _File:
    def __init__(self, path: str) -> None:
        self._path = path
        self._constructor = yaml.constructor.SafeConstructor()
        self._left = 100_000  # nodes; aliases of aliases can make any number

    def whole(self, root: yaml.Node | None) -> Entity:
        if root is None:
            raise LaunchError("this file is empty: expected 'launch:' with a list", (self._path, 1))
        pairs = self._pairs(root) if isinstance(root, yaml.MappingNode) else []
        if [key for key, _, _ in pairs] != ["launch"]:
            raise LaunchError("expected one key 'launch' with a list of entities", self._place(root))
        return self._element("launch", pairs[0][2], self._place(root), 0)

    def _element(self, kind: str, node: yaml.Node, place: Place, depth: int) -> Entity:
        self._left -= 1
        if depth > MAX_DEPTH or self._left < 0:
            raise LaunchError("too many elements within each other", place)
        element = Entity(kind, place, False)
        if isinstance(node, yaml.SequenceNode):
            element.children += self._entities(node, depth)
            return element
        if not isinstance(node, yaml.MappingNode):
            if isinstance(node, yaml.ScalarNode) and node.value == "":
                return element
            raise LaunchError(f"'{kind}' must be a mapping of its attributes, or a list of entities", place)
        for key, key_place, value in self._pairs(node):
            if key == _CHILDREN:
                if not isinstance(value, yaml.SequenceNode):
                    raise LaunchError("'children' must be a list of entities", key_place)
                element.children += self._entities(value, depth)
            elif isinstance(value, yaml.SequenceNode) and value.value and self._holds_mappings(value):
                for each in value.value:
                    element.children.append(self._element(key, each, self._place(each), depth + 1))
            elif isinstance(value, yaml.MappingNode):
                raise LaunchError(f"'{key}' of '{kind}' must be a value or a list, got a mapping", key_place)
            else:
                read = self._parameter if key == "value" and kind in _PARAMETERS else self._value
                element.attributes[key] = (read(value), self._place(value))
        return element

    def _entities(self, node: yaml.SequenceNode, depth: int) -> list[Entity]:
        found: list[Entity] = []
        for each in node.value:
            pairs = self._pairs(each) if isinstance(each, yaml.MappingNode) else []
            if len(pairs) != 1:
                message = "expected an entity: one key, such as 'node:', with its attributes"
                raise LaunchError(message, self._place(each), "indent the attributes below it")
            kind, place, value = pairs[0]
            found.append(self._element(kind, value, place, depth + 1))
        return found

    def _holds_mappings(self, node: yaml.SequenceNode) -> bool:
        kinds = {isinstance(each, yaml.MappingNode) for each in node.value}
        if len(kinds) > 1:
            raise LaunchError("a list of values and mappings together", self._place(node))
        return kinds.pop()

    def _pairs(self, node: yaml.MappingNode) -> list[tuple[str, Place, yaml.Node]]:
        found: dict[str, tuple[str, Place, yaml.Node]] = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode) or not isinstance(key.value, str):
                raise LaunchError("a key must be a word", self._place(key))
            if key.tag == "tag:yaml.org,2002:merge":
                raise LaunchError("merge keys ('<<') are not read in launch files", self._place(key))
            if key.value in found:
                raise LaunchError(f"the key '{key.value}' is there twice", self._place(key))
            found[key.value] = (key.value, self._place(key), value)
        return list(found.values())

    def _value(self, node: yaml.Node) -> Any:
        place = self._place(node)
        if isinstance(node, yaml.SequenceNode):
            if not all(isinstance(each, yaml.ScalarNode) for each in node.value):
                raise LaunchError("a list within a list", place)
            return [self._value(each) for each in node.value]
        try:
            value = self._constructor.construct_object(node, deep=True)
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            raise LaunchError(f"this value cannot be read: {str(error).splitlines()[0]}", place) from None
        if value is not None and not isinstance(value, bool | int | float | str):
            raise LaunchError(f"a value of type {type(value).__name__}: put it in quotes", place)
        return value

    def _parameter(self, node: yaml.Node) -> Any:
        """The value of a parameter, whose scalars are those of a parameter file."""
        if isinstance(node, yaml.SequenceNode) and all(
            isinstance(each, yaml.ScalarNode) for each in node.value
        ):
            return [self._parameter(each) for each in node.value]
        if isinstance(node, yaml.ScalarNode) and node.value and not node.style:
            return read_scalar(node.value)
        return self._value(node)

    def _place(self, node: yaml.Node) -> Place:
        return self._path, node.start_mark.line + 1


class Parser(frontend.Parser):
    """Builds actions from launch files in YAML."""

    @classmethod
    def get_available_extensions(cls) -> list[str]:
        """Return the ends of the names of files that it reads."""
        return ["yaml", "yml"]
