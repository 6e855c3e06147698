"""The contexts of adapters and of their tests: frozen dataclasses whose strings are finished Python text."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FrozenModule:
    """The module of an interface as it was.

    `home` is the `__name__` that its classes know it by, which tells ROS the name of the type. `classes` are
    their names.
    """

    home: str
    classes: str


@dataclass(frozen=True, slots=True)
class ValueText:
    """An argument of a constructor: `name` is the field. `note` is the comment beside it.

    `question` is what a person has to decide, as a Python string; then there is no `value`.
    """

    name: str
    value: str
    note: str
    question: str


@dataclass(frozen=True, slots=True)
class LostText:
    """A value that the target has no field for, and what a person has to decide, as a Python string."""

    value: str
    question: str


@dataclass(frozen=True, slots=True)
class FunctionText:
    """A function that makes a message of class `result` of a message of class `source`."""

    head: str
    docstring: str
    result: str
    lost: tuple[LostText, ...]
    values: tuple[ValueText, ...]


@dataclass(frozen=True, slots=True)
class RegistrationText:
    """An adapter as it is registered: its arguments, as (name, value)."""

    arguments: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class AdapterModule:
    """A module of adapters. `origin` is what the old version was read from, as somebody wrote it."""

    title: str
    origin: str
    old_hash: str
    new_hash: str
    imports: tuple[str, ...]
    functions: tuple[FunctionText, ...]
    registrations: tuple[RegistrationText, ...]
    is_open: bool


@dataclass(frozen=True, slots=True)
class AdapterPackage:
    """The folder of adapters."""

    title: str


@dataclass(frozen=True, slots=True)
class CheckText:
    """A function of a test that compares two messages: its statements, in order."""

    head: str
    docstring: str
    statements: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AdapterCase:
    """A message, or a part of a service or an action, in the tests of an adapter.

    `name` is in capitals, and `title` a comment. `old` and `new` are its classes, and `old_messages` and
    `new_messages` strategies for them. `populated` makes an old message without any default in it, and
    `recorded` are its bytes, in lines of hexadecimal digits. `fields` are those that `upgrade` sets then.
    `check` compares a message with the one that it was made of, `check_downgrade` the other way, and `kept` a
    message with what is left of it after `downgrade` and `upgrade`. The last three are empty without a
    downgrade.
    """

    name: str
    title: str
    old: str
    new: str
    old_hash: str
    upgrade: str
    check: str
    downgrade: str
    check_downgrade: str
    kept: str
    populated: str
    recorded: tuple[str, ...]
    fields: str
    old_messages: str
    new_messages: str


@dataclass(frozen=True, slots=True)
class AdapterTests:
    """The tests of a module of adapters; `module` is its name.

    `imports` are modules of message classes, and `own_import` is the statement that imports those of frozen
    ones. `values` and `strategies` are those of hypothesis, as (name, strategy).
    """

    title: str
    module: str
    imports: tuple[str, ...]
    own_import: str
    values: tuple[tuple[str, str], ...]
    strategies: tuple[tuple[str, str], ...]
    checks: tuple[CheckText, ...]
    cases: tuple[AdapterCase, ...]
