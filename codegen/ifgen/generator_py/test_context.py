"""What the templates of tests are given: frozen dataclasses whose strings are finished Python text."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MessageCase:
    """What the tests know of a message class: `arguments` are those of a Case, as (name, value)."""

    message: str
    strategy: str
    arguments: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class InterfaceTests:
    """The test module of an interface package.

    `imports` are the modules of message classes, `values` the strategies of values that are no messages, and
    `strategies` those of messages, each after those that it needs; both as (name, strategy).
    """

    title: str
    imports: tuple[str, ...]
    values: tuple[tuple[str, str], ...]
    strategies: tuple[tuple[str, str], ...]
    cases: tuple[MessageCase, ...]
    has_floats: bool
