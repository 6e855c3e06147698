"""Reads YAML of anybody's within limits: a text of a hundred characters may stand for billions of values."""

from __future__ import annotations

from typing import Any, Final

import yaml

MAX_CHARACTERS: Final = 2_000_000
"""The longest text that is read, in some ten seconds. JSON has no limit, and is a hundred times as fast."""

MAX_VALUES: Final = 500_000
"""The limit on values, counting aliased ones at each use. A picture of 640 x 480 points has 307,200."""

MAX_DEPTH: Final = 100
"""Lists and maps inside each other."""

_LONGEST_SEXAGESIMAL: Final = 100
_NUMBERS: Final = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")


class YamlError(Exception):
    """A text is no YAML, or goes beyond the limits; the text of the error says why, and where."""


def read(text: object) -> Any:
    """The one document in a text, as PyYAML's `safe_load` reads it; None if it is empty. Raises YamlError."""
    if not isinstance(text, str | bytes):
        raise YamlError(f"expected str or bytes, got {type(text).__name__}")
    if len(text) > MAX_CHARACTERS:
        raise YamlError(f"the text is longer than {MAX_CHARACTERS} characters; JSON has no such limit")
    loader = None
    try:
        loader = _Loader(text)
        return loader.get_single_data()
    except yaml.YAMLError as error:
        raise YamlError(_told(error)) from None
    except RecursionError:  # maps that merge others that merge others
        raise YamlError("aliases are nested too deeply") from None
    except (ValueError, OverflowError):
        # PyYAML leaves to Python what it cannot have, such as the character of "\UFFFFFFFF".
        place = "" if loader is None else _place(loader.get_mark())
        raise YamlError(f"the number is too large{place}") from None


def _told(error: yaml.YAMLError) -> str:
    """The message of PyYAML, in one line."""
    if not isinstance(error, yaml.MarkedYAMLError):
        return " ".join(str(error).split())
    parts = ((error.context, error.context_mark), (error.problem, error.problem_mark))
    return ", ".join(f"{said}{_place(mark)}" for said, mark in parts if said)


def _place(mark: yaml.Mark | None) -> str:
    return "" if mark is None else f" at line {mark.line + 1}, column {mark.column + 1}"


class _Loader(yaml.SafeLoader):
    """PyYAML's, with limits, and with one kind of error for values that are not what their tag says."""

    def __init__(self, text: str | bytes) -> None:
        super().__init__(text)
        self._depth = 0
        self._values = 0
        self._sizes: dict[yaml.Node, int] = {}

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Count what is composed, at each use of it."""
        is_alias = self.check_event(yaml.AliasEvent)
        before = self._values
        self._values += 1
        self._depth += 1
        self._check(self._depth <= MAX_DEPTH, f"lists and maps are more than {MAX_DEPTH} deep")
        node = super().compose_node(parent, index)
        self._depth -= 1
        if node is not None:
            if is_alias:
                # An alias inside of what it stands for has no size yet; `from_dict` would never end.
                self._check(node in self._sizes, "an alias is inside its own value")
                self._values += self._sizes[node] - 1
            else:
                self._sizes[node] = self._values - before
            self._check(self._values <= MAX_VALUES, f"there are more than {MAX_VALUES} values")
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """The value of a node. Raises YAMLError for whatever PyYAML's constructors raise."""
        if node.tag in _NUMBERS and ":" in node.value and len(node.value) > _LONGEST_SEXAGESIMAL:
            raise self._error("the number is too long", node)  # it takes a time that is quadratic
        try:
            value: Any = super().construct_object(node, deep)  # pyright: ignore[reportUnknownMemberType]
            return value  # PyYAML says nothing about its types
        except (yaml.YAMLError, RecursionError):
            raise
        except Exception:
            raise self._error(f"this is not a valid {node.tag.rpartition(':')[2]}", node) from None

    def _check(self, holds: bool, otherwise: str) -> None:
        if not holds:
            raise yaml.MarkedYAMLError(None, None, otherwise, self.get_mark())

    @staticmethod
    def _error(problem: str, node: yaml.Node) -> yaml.MarkedYAMLError:
        return yaml.MarkedYAMLError(None, None, problem, node.start_mark)
