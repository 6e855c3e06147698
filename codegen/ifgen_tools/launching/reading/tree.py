"""Launch files in XML and YAML as trees of elements, and the values in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

from ifgen_tools.launching.errors import LaunchError, Place
from ifgen_tools.launching.reading.texts import parse

MAX_DEPTH = 100
"""Elements within elements; a file with more was not written by people."""


@dataclass
class Element:
    """One entity of a file: its kind, such as `node`, its attributes and the elements inside.

    `values_are_texts` in XML, where the type of a value has to be found. Each attribute and each kind of
    children is asked for once; `finish` refuses the others.
    """

    kind: str
    place: Place
    values_are_texts: bool
    attributes: dict[str, tuple[Any, Place]] = field(default_factory=dict[str, tuple[Any, Place]])
    children: list[Element] = field(default_factory=list["Element"])
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
        if isinstance(value, str) and value.strip().lower() in {"true", "false", "1", "0"}:
            return value.strip().lower() in {"true", "1"}
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

    def inside(self, kind: str) -> Iterator[Element]:
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
