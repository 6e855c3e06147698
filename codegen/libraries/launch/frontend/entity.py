# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Launch files in XML and YAML as trees of elements, and the values in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final, get_args

import yaml

from launch._errors import LaunchError, Place
from launch.frontend.parse_substitution import parse
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

MAX_DEPTH = 100
"""Entitys within elements; a file with more was not written by people."""

_TRUTHS: Final = {
    **dict.fromkeys(("true", "1", "yes", "on"), True),
    **dict.fromkeys(("false", "0", "no", "off"), False),
}
_SCALARS: Final = (int, float, bool, str)


@dataclass
class Entity:
    """One entity of a file: its kind, such as `node`, its attributes and the elements inside.

    `values_are_texts` in XML, where the type of a value has to be found. Each attribute and each kind of
    children is asked for once; `finish` refuses the others.
    """

    kind: str
    place: Place
    values_are_texts: bool
    attributes: dict[str, tuple[Any, Place]] = field(default_factory=dict[str, tuple[Any, Place]])
    children: list[Entity] = field(default_factory=list["Entity"])
    around: Entity | None = None
    _asked: set[str] = field(default_factory=set[str])

    def error(self, message: str, help: str = "") -> LaunchError:
        """Return an error at this place."""
        return LaunchError(message, self.place, help)

    def raw(self, name: str) -> Any:
        """Return the value of an attribute as it is written; None if there is none."""
        self._asked.add(name)
        return self.attributes[name][0] if name in self.attributes else None

    def text(self, name: str) -> str | None:
        """Return an attribute that is a text; None if there is none. Raises LaunchError."""
        value = self.raw(name)
        if value is not None and not isinstance(value, str):
            shown = yaml.safe_dump(value, default_flow_style=True).partition("\n")[0]
            raise LaunchError(
                f"'{name}' of '{self.kind}' must be a text, got {shown}",
                self.attributes[name][1],
                f"put it in quotes, such as '{shown}'" if isinstance(value, int | float) else "",
            )
        return value

    def plain(self, name: str) -> str | None:
        """Return a text without substitutions; None if there is none. Raises LaunchError."""
        found = self.substitutions(name)
        if found is None:
            return None
        if not all(isinstance(each, TextSubstitution) for each in found):
            raise LaunchError(
                f"'{name}' of '{self.kind}' cannot have substitutions", self.attributes[name][1]
            )
        return "".join(each.text for each in found if isinstance(each, TextSubstitution))

    def substitutions(self, name: str) -> list[Substitution] | None:
        """Return a text with its substitutions; None if there is none. Raises LaunchError."""
        text = self.text(name)
        return None if text is None else parse(text, self.attributes[name][1])

    def needed(self, name: str) -> list[Substitution]:
        """Return a text that must be there. Raises LaunchError."""
        found = self.substitutions(name)
        if found is None:
            raise self.error(f"'{self.kind}' needs the attribute '{name}'")
        return found

    def truth(self, name: str) -> bool | list[Substitution] | None:
        """Return a truth, or the substitutions that it comes from. Raises LaunchError."""
        value = self.raw(name)
        if value is None or isinstance(value, bool):
            return value
        if isinstance(value, str) and value.strip().lower() in _TRUTHS:
            return _TRUTHS[value.strip().lower()]
        if isinstance(value, str) and "$(" in value:
            return self.substitutions(name)
        raise LaunchError(
            f"'{name}' of '{self.kind}' must be true or false, got {value!r}", self.attributes[name][1]
        )

    def number(self, name: str) -> float | None:
        """Return a number; None if there is none. Raises LaunchError."""
        value = self.raw(name)
        if value is None:
            return None
        try:
            if isinstance(value, bool):
                raise ValueError
            return float(value)
        except (TypeError, ValueError):
            message = f"'{name}' of '{self.kind}' must be a number, got {value!r}"
            raise LaunchError(message, self.attributes[name][1]) from None

    def inside(self, kind: str) -> Iterator[Entity]:
        """Return the elements of a kind inside, such as the `param` of a node."""
        self._asked.add(kind)
        if kind in self.attributes:
            raise LaunchError(
                f"'{kind}' of '{self.kind}' must be a list of elements", self.attributes[kind][1]
            )
        return (child for child in self.children if child.kind == kind)

    def finish(self, *, but: str = "") -> None:
        """Raise LaunchError for an attribute or an element that nobody asked for, except within `but`."""
        for name, (_, place) in self.attributes.items():
            if name not in self._asked:
                known = ", ".join(sorted(self._asked)) or "none"
                raise LaunchError(f"'{self.kind}' has no attribute '{name}'", place, f"it has {known}")
        for child in self.children:
            if child.kind in self._asked:
                child.finish()
            elif not but:
                raise child.error(f"'{self.kind}' has no '{child.kind}' inside")

    # The names of upstream, for the methods `parse` of users.

    @property
    def type_name(self) -> str:
        """The kind of this element, such as `node`."""
        return self.kind

    @property
    def parent(self) -> Entity | None:
        """The element around this one; None for the outermost."""
        return self.around

    def get_attr(
        self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True
    ) -> Any:
        """Return an attribute as a value of a type, or the elements inside of a kind, for `list[Entity]`.

        Without the attribute: None if it is `optional`, else AttributeError. A text that is no such value is
        returned as it is if `can_be_str`, since it may have substitutions; else it is a TypeError.
        """
        inner = get_args(data_type)[0] if get_args(data_type) else None
        if inner is Entity:
            found = list(self.inside(name))
            if found or optional:
                return found or None
        elif name in self.attributes:
            return self._value(name, data_type, inner, can_be_str=can_be_str)
        elif optional:
            return None
        raise AttributeError(f"'{self.kind}' needs the attribute '{name}'")

    def assert_entity_completely_parsed(self) -> None:
        """Raise LaunchError for an attribute or an element that nobody asked for."""
        self.finish()

    def _value(self, name: str, data_type: Any, inner: Any, *, can_be_str: bool) -> Any:
        value = self.raw(name)
        if inner is not None:
            values = value if isinstance(value, list) else [part.strip() for part in str(value).split(",")]
            return [self._one(name, each, inner, can_be_str=can_be_str) for each in values]
        return value if data_type is None else self._one(name, value, data_type, can_be_str=can_be_str)

    def _one(self, name: str, value: Any, data_type: Any, *, can_be_str: bool) -> Any:
        if data_type is str and self.values_are_texts:
            return value
        if isinstance(value, str) and data_type is bool and value.strip().lower() in _TRUTHS:
            return _TRUTHS[value.strip().lower()]
        if isinstance(value, str) and data_type in {int, float} and self.values_are_texts:
            try:
                return data_type(value)
            except ValueError:
                pass
        if type(value) is data_type or (data_type is float and type(value) is int):
            return data_type(value)
        if isinstance(value, str) and can_be_str:
            return value
        wanted = data_type.__name__ if data_type in _SCALARS else data_type
        raise TypeError(f"'{name}' of '{self.kind}' must be of type {wanted}, got {value!r}")
